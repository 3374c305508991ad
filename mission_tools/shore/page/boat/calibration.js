// Calibration: each kind with what it needs, its progress and its result. The state comes with the boat's snapshot, so
// that every page shows it, and one that was away.
import { makeKind } from "./calibration-kind.js";
import { makeFieldRun } from "./calibration-field.js";
import { element, setText } from "../shared/elements.js";

export const title = "calibrate.title";

const hasFix = (state) => ["3D", "DGPS", "RTK float", "RTK fixed"].includes(state.fix?.type);
const isArmed = (state) => state.armed === true;
const isDisarmed = (state) => state.armed === false;
const keepsPlace = (state) => state.mode === "LOITER";

// needs: what must be so before it starts. sails: the boat moves by itself. extra: more to do while it runs.
const AT_REST = [["calibrate.need.disarmed", isDisarmed]];
const SAILING = [["calibrate.need.fix", hasFix], ["calibrate.need.armed", isArmed], ["calibrate.need.place", keepsPlace]];
const KINDS = [
  { kind: "compass", needs: AT_REST, keeps: true },
  { kind: "gyro", needs: AT_REST },
  { kind: "motor_field", needs: AT_REST, extra: makeFieldRun },
  { kind: "thrusters", needs: SAILING, sails: true },
  { kind: "heading", needs: SAILING, sails: true },
  { kind: "stop", needs: SAILING, sails: true },
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
