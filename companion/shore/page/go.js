// Go: what the skipper asks of the boat, and what it answered.
import { holdButton } from "./hold-button.js";
import { setText } from "./now.js";

const SPEED = { least: 0.2, most: 5, step: 0.1 };

// Buttons that are pressed and held, and those that act at once: element, what, its name in the words.
const HELD = [
  ["hold", "hold", "go.hold"],
  ["return", "return", "go.return"],
  ["stop", "stop", "go.stop"],
];
const TAPPED = [
  ["start", "start", "go.start"],
  ["pause", "pause", "go.pause"],
  ["continue", "continue", "go.continue"],
];

export function makeGo(page, words, live) {
  let speed_m_s = 1;
  let armed = false;

  let hasTold = false;
  const tell = (text, isGood = null) => {
    hasTold = true;
    setText(page.answer, `${isGood === true ? "✓ " : isGood === false ? "✕ " : ""}${text}`);
    page.answer.dataset.level = isGood === true ? "good" : isGood === false ? "bad" : "";
  };

  const ask = async (what, withThese, name) => {
    tell(words.say("go.asked", { name }));
    const answer = await live.ask(what, withThese);
    const otherwise = words.say(answer.lost ? "go.lost" : answer.ok ? "go.done" : answer.ok === null ? "go.unknown" : "go.refused");
    const text = answer.text || otherwise;
    tell(text.startsWith(`${name}:`) ? text : words.say("go.answer", { name, text }), answer.ok === true);
    return answer;
  };

  const hold = (button, act, name) =>
    holdButton(button, act, (isByReader) => tell(words.say(isByReader ? "go.again" : "go.longer", { name: name() })));

  for (const [id, what, key] of HELD) hold(page[id], () => ask(what, {}, words.say(key)), () => words.say(key));
  for (const [id, what, key] of TAPPED) page[id].addEventListener("click", () => ask(what, {}, words.say(key)));
  const armName = () => words.say(armed ? "go.disarm" : "go.arm");
  hold(page.arm, () => ask(armed ? "disarm" : "arm", {}, armName()), armName);

  const showSpeed = () => setText(page.speedText, words.speed(speed_m_s));
  const changeSpeed = (by) => {
    const steps = Math.round((speed_m_s + by) / SPEED.step);
    speed_m_s = Math.min(SPEED.most, Math.max(SPEED.least, Number((steps * SPEED.step).toFixed(1))));
    showSpeed();
  };
  page.slower.addEventListener("click", () => changeSpeed(-SPEED.step));
  page.faster.addEventListener("click", () => changeSpeed(SPEED.step));
  page.speed.addEventListener("click", () => ask("speed", { m_s: speed_m_s }, words.say("go.speed")));
  showSpeed();

  page.setMode.addEventListener("click", () => ask("set_mode", { mode: page.modes.value }, words.say("go.mode")));
  page.more.addEventListener("click", () => {
    const isOpen = page.box.classList.toggle("all");
    page.more.setAttribute("aria-expanded", String(isOpen));
  });

  let modesShown = "";
  const showState = (state) => {
    armed = state.armed === true;
    page.box.classList.toggle("armed", armed); // the other views then show Hold, Return and Motors off
    setText(page.armText, armName());
    const modes = state.modes ?? [];
    if (modes.join() !== modesShown) {
      modesShown = modes.join();
      page.modes.replaceChildren(...modes.map((mode) => new Option(words.sayOr(`mode.${mode}`, mode), mode, false, mode === state.mode)));
    }
  };
  const showLink = () => {
    if (!hasTold) setText(page.answer, words.say(live.isSkipper ? "go.ready" : "go.viewer"));
    page.buttons.disabled = !(live.isConnected && live.isSkipper && live.snapshot !== null);
  };
  return { ask, tell, showState, showLink };
}
