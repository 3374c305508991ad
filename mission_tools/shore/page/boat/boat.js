// Boat: setting up, in panels that open one at a time. A panel is a module that exports makePanel(box, page) and
// `title`, a key of the words; it returns what it wants to hear, as a view does.
import { element } from "../shared/elements.js";
import * as calibration from "./calibration.js";
import * as motors from "./motors.js";
import * as parameters from "./parameters.js";
import * as restart from "./restart.js";
import * as sensors from "./sensors.js";

const PANELS = [sensors, calibration, motors, parameters, restart];

export function makeView(box, page) {
  const panels = PANELS.map(({ title, makePanel }, index) => {
    const inside = element("div");
    const summary = element("summary", {}, element("h2", { text: page.words.say(title) }));
    const details = element("details", {}, summary, inside);
    details.name = "boat-panel"; // the browser closes the others
    details.open = index === 0;
    box.append(details);
    return { details, inside, makePanel, heard: null, isEntered: false };
  });
  let isOpen = false;
  let shown = null;

  // Each panel hears of its opening and closing once, whether the view or the panel itself is opened or closed.
  const follow = (panel) => {
    const isSeen = isOpen && panel.details.open;
    if (isSeen === panel.isEntered) return;
    panel.isEntered = isSeen;
    if (!isSeen) {
      panel.heard.closed?.();
      return;
    }
    panel.heard = panel.heard ?? panel.makePanel(panel.inside, page) ?? {};
    panel.heard.opened?.();
    if (shown !== null) panel.heard.showState?.(shown);
  };
  for (const panel of panels)
    panel.details.addEventListener("toggle", () => {
      const wasEntered = panel.isEntered;
      follow(panel);
      if (panel.isEntered && !wasEntered) panel.details.scrollIntoView({ block: "start" });
    });
  return {
    opened() {
      isOpen = true;
      panels.forEach(follow);
    },
    closed() {
      isOpen = false;
      panels.forEach(follow);
    },
    showState(snapshot) {
      shown = snapshot;
      for (const panel of panels) if (panel.isEntered) panel.heard.showState?.(snapshot);
    },
  };
}
