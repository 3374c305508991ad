// Go: what the skipper asks of the boat, and what it answered.
import { setAnswer, setText } from "../shared/elements.js";
import { holdButton } from "../shared/hold.js";

const SPEED = { least: 0.2, most: 5, step: 0.1 };

// Buttons that are pressed and held, and those that act at once; each is named by its request.
const HELD = ["hold", "return", "stop"];
const TAPPED = ["start", "pause", "continue"];

export function makeGo(page, words, live) {
  let speed_m_s = 1;
  let armed = false;

  let hasTold = false;
  const tell = (text, isGood = null) => {
    hasTold = true;
    setAnswer(page.answer, text, isGood);
  };

  const ask = async (what, withThese, name) => {
    tell(words.say("go.asked", { name }));
    const answer = await live.ask(what, withThese);
    const otherwise = words.say(answer.lost ? "go.lost" : answer.ok ? "go.done" : answer.ok === null ? "go.unknown" : "go.refused");
    const text = answer.text || otherwise;
    tell(text.startsWith(`${name}:`) ? text : words.say("go.answer", { name, text }), answer.ok === true);
    return answer;
  };

  for (const id of HELD) {
    const name = words.say(`go.${id}`);
    holdButton(page[id], () => ask(id, {}, name), name, words, tell);
  }
  for (const id of TAPPED) page[id].addEventListener("click", () => ask(id, {}, words.say(`go.${id}`)));
  const armName = () => words.say(armed ? "go.disarm" : "go.arm");
  holdButton(page.arm, () => ask(armed ? "disarm" : "arm", {}, armName()), armName, words, tell);

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

  // The chooser follows the boat's mode, until somebody chooses another: only that can be set.
  let mode = ""; // the boat's
  let isChosen = false;
  const followMode = () => {
    isChosen = isChosen && page.modes.value !== mode;
    if (!isChosen && page.modes.value !== mode) page.modes.value = mode;
    page.setMode.disabled = !isChosen;
  };
  page.modes.addEventListener("change", () => {
    isChosen = true;
    followMode();
  });
  page.setMode.addEventListener("click", async () => {
    await ask("set_mode", { mode: page.modes.value }, words.say("go.mode"));
    isChosen = false;
    followMode();
  });
  page.more.addEventListener("click", () => {
    const isOpen = page.box.classList.toggle("all");
    page.more.setAttribute("aria-expanded", String(isOpen));
  });

  let modesShown = "";
  const showState = (state) => {
    armed = state.armed === true;
    page.box.classList.toggle("armed", armed); // the other views then show Hold, Return and Motors off
    page.box.classList.toggle("disarmed", state.armed === false); // a phone then shows Arm
    setText(page.armText, armName());
    const modes = state.modes ?? [];
    if (modes.join() !== modesShown) {
      modesShown = modes.join();
      page.modes.replaceChildren(...modes.map((name) => new Option(words.sayOr(`mode.${name}`, name), name)));
    }
    isChosen = isChosen && mode === (state.mode ?? ""); // the boat has changed meanwhile: choose again
    mode = state.mode ?? "";
    followMode();
  };
  const showLink = () => {
    if (!hasTold) setText(page.answer, words.say(live.isSkipper ? "go.ready" : "go.viewer"));
    page.buttons.disabled = !(live.isConnected && live.isSkipper && live.snapshot !== null);
  };
  return { ask, tell, showState, showLink };
}
