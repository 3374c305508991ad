// Calibration: each kind with what it needs, its progress and its result. The state comes with the boat's snapshot, so
// that every page shows it, and one that was away.
import { makeKind } from "./calibration-kind.js";
import { makeFieldRun } from "./calibration-field.js";
import { element } from "./elements.js";
import { setText } from "./now.js";

export const title = "calibrate.title";

const hasFix = (state) => ["3D", "DGPS", "RTK float", "RTK fixed"].includes(state.fix?.type);
const isArmed = (state) => state.armed === true;
const isDisarmed = (state) => state.armed === false;
const keepsPlace = (state) => state.mode === "LOITER";

// needs: what must be so before it starts. sails: the boat moves by itself. extra: more to do while it runs.
const KINDS = [
  {
    kind: "compass", name: "calibrate.compass", about: "calibrate.compass.about", running: "calibrate.compass.running",
    silent: "calibrate.compass.silent", needs: [["calibrate.need.disarmed", isDisarmed]], keeps: true,
  },
  {
    kind: "gyro", name: "calibrate.gyro", about: "calibrate.gyro.about", running: "calibrate.gyro.running",
    silent: "calibrate.gyro.silent", needs: [["calibrate.need.disarmed", isDisarmed]],
  },
  {
    kind: "motor_field", name: "calibrate.motor_field", about: "calibrate.motor_field.about", running: "calibrate.motor_field.running",
    silent: "calibrate.motor_field.silent", needs: [["calibrate.need.disarmed", isDisarmed]], extra: makeFieldRun,
  },
  {
    kind: "thrusters", name: "calibrate.thrusters", about: "calibrate.thrusters.about", running: "calibrate.thrusters.running",
    silent: "calibrate.sailing.silent", sails: true,
    needs: [["calibrate.need.fix", hasFix], ["calibrate.need.armed", isArmed], ["calibrate.need.place", keepsPlace]],
  },
  {
    kind: "heading", name: "calibrate.heading", about: "calibrate.heading.about", running: "calibrate.heading.running",
    silent: "calibrate.sailing.silent", sails: true,
    needs: [["calibrate.need.fix", hasFix], ["calibrate.need.armed", isArmed], ["calibrate.need.place", keepsPlace]],
  },
];

export function makePanel(inside, page) {
  const who = element("p", { className: "calibrate-who", text: page.words.say("calibrate.viewer") });
  const box = element("div", { className: "calibrations" });
  inside.append(who, box);
  const kinds = KINDS.map((kind) => makeKind(box, page, kind));
  return {
    closed: () => kinds.forEach((kind) => kind.closed()),
    showState(state) {
      who.hidden = page.live.isSkipper;
      setText(who, page.words.say("calibrate.viewer"));
      for (const kind of kinds) kind.show(state);
    },
  };
}
