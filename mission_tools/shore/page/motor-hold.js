// A button that turns motors while it is held. Each request turns them for a second at most; letting go stops them.
import { requestId } from "./live.js";

const EVERY_MS = 300;
const LONGEST_MS = 20_000; // a thing that lies on the glass
const READER_MS = 500; // a screen reader cannot hold

// asked(): {motor, percent}, or null where nothing may turn now. told(text, isGood): for the skipper.
// Returns stop(), for whatever takes the permission away.
export function holdMotor(button, live, words, { asked, told }) {
  let press = null;
  let downMs = -Infinity;

  const turn = async (own) => {
    if (own !== press) return;
    const what = asked();
    const held_ms = performance.now() - own.beganMs;
    if (what === null || held_ms > LONGEST_MS) {
      stop();
      return;
    }
    own.timer = setTimeout(turn, EVERY_MS, own);
    const answer = await live.ask("motor", { ...what, press: own.name, held_s: held_ms / 1000 }, { isFleeting: true });
    if (answer.ok === true || own !== press) return;
    stop();
    told(answer.text || words.say(answer.lost ? "go.lost" : "motor.silent"), false);
  };

  const start = () => {
    if (press !== null || button.disabled || button.closest("fieldset:disabled") !== null || asked() === null) return;
    press = { name: requestId(), beganMs: performance.now(), timer: null };
    downMs = press.beganMs;
    button.classList.add("turning");
    told(words.say("motor.turning"), null);
    turn(press);
  };

  async function stop() {
    if (press === null) return;
    clearTimeout(press.timer);
    press = null;
    downMs = performance.now();
    button.classList.remove("turning");
    const answer = await live.ask("motor_stop", {}, { isFleeting: true });
    if (press === null) told(answer.text || words.say(answer.lost ? "go.lost" : "motor.silent"), answer.ok === true);
  }

  button.addEventListener("pointerdown", (event) => {
    if (event.button !== 0) return;
    button.setPointerCapture?.(event.pointerId); // the page may move under the finger
    start();
  });
  for (const name of ["pointerup", "pointercancel", "lostpointercapture", "blur"]) button.addEventListener(name, stop);
  button.addEventListener("contextmenu", (event) => event.preventDefault());
  button.addEventListener("keydown", (event) => {
    if (event.key !== " " && event.key !== "Enter") return;
    event.preventDefault();
    if (!event.repeat) start();
  });
  button.addEventListener("keyup", (event) => {
    if (event.key !== " " && event.key !== "Enter") return;
    event.preventDefault();
    stop();
  });
  button.addEventListener("click", (event) => {
    if (event.detail !== 0 || performance.now() - downMs < 1_500) return; // not a screen reader's
    start();
    setTimeout(stop, READER_MS);
  });
  document.addEventListener("visibilitychange", () => document.hidden && stop());
  addEventListener("pagehide", stop);
  return stop;
}
