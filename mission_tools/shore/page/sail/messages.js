// The boat's latest messages (STATUSTEXT), newest first.
import { element, setText } from "../shared/elements.js";

const WARNING = 4; // MAV_SEVERITY; 3 and below are errors

export function makeMessages(page, words, clock) {
  let shown = "";
  return (state) => {
    const lines = [...(state.lines ?? [])].sort((a, b) => b.number - a.number);
    const key = lines.map((line) => line.number).join();
    if (key === shown && lines.length > 0) return;
    shown = key;
    setText(page.latest, lines.length > 0 ? signed(lines[0]) : words.say("messages.none"));
    page.list.replaceChildren(...lines.map((line) => entry(line, words, clock)));
  };
}

const signed = ({ severity, text }) => (severity < WARNING ? `✕ ${text}` : severity === WARNING ? `▲ ${text}` : text);

function entry(line, words, clock) {
  const time = new Date(clock.local_s(line.at_s) * 1000).toLocaleTimeString(words.language, { hour12: false });
  const className = line.severity < WARNING ? "error" : line.severity === WARNING ? "warning" : "";
  return element("li", { className }, element("time", { text: time }), element("span", { text: signed(line) }));
}
