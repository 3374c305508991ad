// Motors: each one a little ahead and astern while a button is held, on a disarmed boat.
import { element, pair, setText } from "../shared/elements.js";
import { holdMotor, makeSafe } from "./motor-hold.js";
import { watchSensors } from "./sensor-feed.js";

export const title = "motor.title";

const POWERS = [15, 30, 50];
const REST_US = 1500;
const FULL_US = 500;

// Motor, ahead (1) or astern (-1), name, sign.
const BUTTONS = [
  ["left", 1, "motor.left_ahead", "▲"],
  ["both", 1, "motor.both_ahead", "▲▲"],
  ["right", 1, "motor.right_ahead", "▲"],
  ["left", -1, "motor.left_astern", "▼"],
  ["both", -1, "motor.both_astern", "▼▼"],
  ["right", -1, "motor.right_astern", "▼"],
  ["turn", -1, "motor.turn_port", "↶"],
  ["turn", 1, "motor.turn_starboard", "↷"],
];

// What somebody sees, and what to change.
const HINTS = [
  ["motor.hint.reversed", "motor.hint.reversed.cure"],
  ["motor.hint.swapped", "motor.hint.swapped.cure"],
  ["motor.hint.weak", "motor.hint.weak.cure"],
  ["motor.hint.dead_band", "motor.hint.dead_band.cure"],
];

export function makePanel(inside, page) {
  const { words, live } = page;
  let state = null;
  let power = POWERS[0];
  const stops = [];
  const stopAll = () => stops.forEach((stop) => stop());

  const why = element("p", { className: "motor-why" });
  const safe = makeSafe(words, () => {
    if (!safe.isTicked) stopAll();
    show();
  });
  const sizes = element("div", { className: "motor-sizes" });
  for (const percent of POWERS) {
    const radio = element("input", { type: "radio", name: "motor-power", value: percent, checked: percent === power });
    radio.addEventListener("change", () => {
      stopAll();
      power = percent;
    });
    sizes.append(element("label", {}, radio, element("span", { text: words.percent(percent / 100) })));
  }
  const powers = element("fieldset", {}, element("legend", { text: words.say("motor.power") }), sizes);
  const buttons = element("fieldset", { className: "motor-buttons" }, element("legend", { text: words.say("motor.hold") }));
  for (const [motor, way, key, sign] of BUTTONS) {
    const name = words.say(key);
    const button = element(
      "button",
      { type: "button", className: `motor-button ${motor}` },
      element("span", { className: "sign", "aria-hidden": "true", text: sign }),
      element("span", { text: name }),
    );
    button.setAttribute("aria-label", name);
    const asked = () => (mayTurn() ? { motor, percent: way * power } : null);
    stops.push(holdMotor(button, name, page, asked));
    buttons.append(button);
  }
  const outputs = makeOutputs(words);
  const hints = element("details", { className: "motor-hints" }, element("summary", { text: words.say("motor.hints") }));
  const list = element("dl");
  for (const [seen, cure] of HINTS)
    list.append(element("dt", { text: words.say(seen) }), element("dd", { text: words.say(cure) }));
  hints.append(list);
  inside.append(element("p", { text: words.say("motor.warning") }), safe.label, why, powers, buttons, outputs.box, hints);

  // Armed is said by the boat's heartbeat during a test, too.
  const isTurning = () => buttons.querySelector(".turning") !== null;
  const isReady = () => live.isConnected && live.isSkipper && (state?.armed === false || testedMs() < 3_000);
  let lastTurnMs = -Infinity;
  const testedMs = () => {
    if (isTurning()) lastTurnMs = performance.now();
    return performance.now() - lastTurnMs;
  };
  const mayTurn = () => safe.isTicked && isReady();

  function show() {
    setText(why, words.say(!live.isSkipper ? "motor.viewer" : isReady() ? "motor.tick" : "motor.armed"));
    why.hidden = mayTurn();
    buttons.disabled = !mayTurn();
  }

  const feed = watchSensors(page, (sensors) => {
    outputs.show(sensors);
    show();
  });
  show();
  return {
    opened() {
      safe.untick();
      feed.opened();
    },
    closed() {
      safe.untick();
      feed.closed();
    },
    showState(snapshot) {
      state = snapshot;
      show();
    },
  };
}

// What the boat says of its outputs and its battery.
function makeOutputs(words) {
  const rows = new Map();
  const box = element("dl", { className: "motor-outputs" });
  for (const [name, key] of [["left", "motor.output.left"], ["right", "motor.output.right"], ["current", "motor.current"], ["voltage", "motor.voltage"]]) {
    const value = element("dd", { text: "–", data: { output: name } });
    rows.set(name, value);
    box.append(pair(words.say(key), value));
  }
  const output = (us) =>
    us === undefined || us === 0
      ? "–"
      : words.say("motor.output", { percent: words.percent((us - REST_US) / FULL_US), us: words.say("unit.us", { n: String(us) }) });
  return {
    box,
    show(sensors) {
      const of = (name) => sensors?.find((sensor) => sensor.name === name)?.values ?? {};
      const { current_a, voltage_v } = of("battery");
      setText(rows.get("left"), output(of("motors").left_us));
      setText(rows.get("right"), output(of("motors").right_us));
      setText(rows.get("current"), current_a === undefined ? "–" : words.say("unit.a", { n: words.number(current_a, 2) }));
      setText(rows.get("voltage"), voltage_v === undefined ? "–" : words.say("unit.v", { n: words.number(voltage_v, 2) }));
    },
  };
}
