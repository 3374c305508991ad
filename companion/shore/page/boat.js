// Boat: setting up, in panels that open one at a time. A panel is a module that exports makePanel(box, page) and
// `title`, a key of the words; it returns what it wants to hear, as a view does.

const PANELS = [];

export function makeView(box, page) {
  const panels = PANELS.map(({ title, makePanel }) => {
    const details = document.createElement("details");
    details.name = "boat-panel"; // the browser closes the others
    const summary = document.createElement("summary");
    const inside = document.createElement("div");
    summary.textContent = page.words.say(title);
    details.append(summary, inside);
    box.append(details);
    return { details, inside, makePanel, heard: null };
  });
  let isOpen = false;
  let shown = null;

  const enter = (panel) => {
    panel.heard = panel.heard ?? panel.makePanel(panel.inside, page);
    panel.heard.opened?.();
    if (shown !== null) panel.heard.showState?.(shown);
  };
  for (const panel of panels)
    panel.details.addEventListener("toggle", () => {
      if (!isOpen) return;
      if (panel.details.open) enter(panel);
      else panel.heard?.closed?.();
    });
  const open = () => panels.filter((panel) => panel.details.open);
  return {
    opened() {
      isOpen = true;
      open().forEach(enter);
    },
    closed() {
      isOpen = false;
      for (const panel of open()) panel.heard?.closed?.();
    },
    showState(snapshot) {
      shown = snapshot;
      for (const panel of open()) panel.heard?.showState?.(snapshot);
    },
  };
}
