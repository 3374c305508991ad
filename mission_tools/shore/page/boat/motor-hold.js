// A button that turns motors while it is held, and the box that must be ticked before.
import { ticked } from "../shared/elements.js";
import { isOff, onPress } from "../shared/hold.js";
import { requestId } from "../shared/live.js";

const EVERY_MS = 300; // each request turns them for a second at most
const LONGEST_MS = 20_000; // a thing that lies on the glass
const READER_MS = 500; // a screen reader cannot hold
const TICKED_MS = 60_000;

// asked(): {motor, percent}, or null where nothing may turn now. name: of the button, for what the skipper is told.
// Returns stop(), for whatever takes the permission away.
export function holdMotor(button, name, page, asked) {
  const { live, words } = page;
  let press = null;

  const tell = (answer, isGood) => {
    const text = answer.text || words.say(answer.lost ? "go.lost" : "motor.silent");
    page.go.tell(words.say("go.answer", { name, text }), isGood);
  };
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
    tell(answer, false);
  };

  const start = (event) => {
    if (event?.pointerId !== undefined) button.setPointerCapture?.(event.pointerId); // the page may move under the finger
    if (press !== null || isOff(button) || asked() === null) return;
    press = { name: requestId(), beganMs: performance.now(), timer: null };
    button.classList.add("turning");
    tell({ text: words.say("motor.turning") }, null);
    turn(press);
  };

  async function stop() {
    if (press === null) return;
    clearTimeout(press.timer);
    press = null;
    button.classList.remove("turning");
    const answer = await live.ask("motor_stop", {}, { isFleeting: true });
    if (press === null) tell(answer, answer.ok === true);
  }

  onPress(button, ["pointerup", "pointercancel", "lostpointercapture", "blur"], {
    start,
    end: stop,
    click() {
      start();
      setTimeout(stop, READER_MS);
    },
  });
  document.addEventListener("visibilitychange", () => document.hidden && stop());
  addEventListener("pagehide", stop);
  return stop;
}

// The box: unticked again after a minute, and at each opening. changed(): ticked, unticked, or its time is over.
export function makeSafe(words, changed) {
  const { tick, label } = ticked(words.say("motor.clear"), "motor-safe");
  let timer = null;
  const untick = () => {
    clearTimeout(timer);
    tick.checked = false;
    changed();
  };
  tick.addEventListener("change", () => {
    clearTimeout(timer);
    if (tick.checked) timer = setTimeout(untick, TICKED_MS);
    changed();
  });
  return {
    label,
    untick,
    get isTicked() {
      return tick.checked;
    },
  };
}
