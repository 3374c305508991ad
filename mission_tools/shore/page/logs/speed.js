// Speeds by colour and width: each step is told by both.

const STEPS = 5;
const SLACK = 0.2; // of a step
const DAY = ["#311b92", "#8e24aa", "#d81b60", "#e65100", "#ffb300"];
const NIGHT = ["#8c9eff", "#ce93d8", "#ff8fa3", "#ffab73", "#fff176"];
const WIDTHS = [2.5, 3.5, 4.5, 5.5, 6.5];
const UNKNOWN = { day: "#57524b", night: "#b5afa4" };

// The steps of a voyage: {from, to, width} in m/s and pixels, from 0 to a round speed above the largest.
export function speedSteps(speeds) {
  const most = Math.max(0.1, ...speeds.filter((one) => one !== null));
  const step = Math.ceil((most / STEPS) * 10) / 10;
  return WIDTHS.map((width, n) => ({ from: n * step, to: (n + 1) * step, width }));
}

// last: the step before. A speed about the border of two does not change it.
export function stepOf(steps, speed, last) {
  if (speed === null) return null;
  const wide = steps[0].to;
  if (last !== null && Math.abs(speed - (last + 0.5) * wide) < (0.5 + SLACK) * wide) return last;
  return Math.min(Math.floor(speed / wide), steps.length - 1);
}

export function inkOf(step, isNight) {
  if (step === null) return isNight ? UNKNOWN.night : UNKNOWN.day;
  return (isNight ? NIGHT : DAY)[step];
}
