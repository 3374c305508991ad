// The motors' field at the compass: while it is measured, somebody runs both motors of the moored boat, more and more,
// then lets them rest.
import { element } from "../shared/elements.js";
import { holdMotor, makeSafe } from "./motor-hold.js";

const POWERS = [15, 30, 50];

export function makeFieldRun(box, page) {
  const { words, live } = page;
  const stops = [];
  const stopAll = () => stops.forEach((stop) => stop());
  let isRunning = false;
  const fields = element("fieldset", { className: "motor-buttons" }, element("legend", { text: words.say("calibrate.motor_field.hold") }));
  const safe = makeSafe(words, () => {
    if (!safe.isTicked) stopAll();
    show();
  });
  for (const percent of POWERS) {
    const name = words.say("calibrate.motor_field.power", { percent: words.percent(percent / 100) });
    const one = element("button", { type: "button", className: "motor-button", text: name });
    const asked = () => (isRunning && safe.isTicked ? { motor: "both", percent } : null);
    stops.push(holdMotor(one, name, page, asked));
    fields.append(one);
  }
  box.append(safe.label, fields);

  function show() {
    fields.disabled = !(isRunning && safe.isTicked && live.isSkipper);
  }
  return {
    show(state, runs) {
      box.hidden = !runs;
      isRunning = runs;
      if (!runs && safe.isTicked) safe.untick();
      show();
    },
    closed: () => safe.untick(),
  };
}
