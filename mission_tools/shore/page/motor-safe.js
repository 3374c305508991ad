// The box that must be ticked before a motor may turn. It is unticked again after a minute, and at each opening.
import { element } from "./elements.js";

const TICKED_MS = 60_000;

// changed(): ticked, unticked, or its time is over.
export function makeSafe(words, changed) {
  const box = element("input", { type: "checkbox" });
  const label = element("label", { className: "motor-safe" }, box, element("span", { text: words.say("motor.clear") }));
  let timer = null;
  const untick = () => {
    clearTimeout(timer);
    box.checked = false;
    changed();
  };
  box.addEventListener("change", () => {
    clearTimeout(timer);
    if (box.checked) timer = setTimeout(untick, TICKED_MS);
    changed();
  });
  return {
    label,
    untick,
    get isTicked() {
      return box.checked;
    },
  };
}
