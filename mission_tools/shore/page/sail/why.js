// Why not: why the boat does not arm, or which failsafe acts, and what to do next.
import { element, setText } from "../shared/elements.js";

export function makeWhy(page, words) {
  let shown = "";
  return (state) => {
    const reasons = [...(state.reasons ?? [])].sort((a, b) => a.severity - b.severity); // 0 is the gravest
    const key = JSON.stringify([reasons, state.armed]);
    if (key === shown) return;
    shown = key;
    page.box.hidden = reasons.length === 0;
    if (reasons.length === 0) return;
    setText(page.title, words.say(state.armed ? "why.armed" : "why.disarmed"));
    setText(page.first, why(reasons[0], words) || reasons[0].text);
    setText(page.count, reasons.length > 1 ? words.say("why.more", { n: reasons.length - 1 }) : words.say("why.how"));
    page.list.replaceChildren(...reasons.map((reason) => entry(reason, words)));
  };
}

const why = (reason, words) => words.sayOr(`reason.${reason.key}.why`, reason.why);

function entry(reason, words) {
  const [meaning, next] = [why(reason, words), words.sayOr(`reason.${reason.key}.next`, reason.next)];
  const lines = [["why", meaning || reason.text], ["next", next], ["wire", meaning ? reason.text : ""]];
  return element("li", {}, ...lines.map(([className, text]) => text && element("p", { className, text })).filter(Boolean));
}
