// A graph over time. It is a slider: a finger, the mouse or the arrow keys choose a moment.
import { colours, isNight } from "../shared/chart-colours.js";
import { element } from "../shared/elements.js";
import { sharpened, whenLight } from "./canvas.js";
import { clock } from "./words.js";

const PAD = { left: 46, right: 12, top: 22, bottom: 22 };
const KEYS = { ArrowLeft: -1, ArrowDown: -1, ArrowRight: 1, ArrowUp: 1, PageDown: -10, PageUp: 10 };
const ROUND = [1, 2, 5];
const LINES = 4; // of the grid, across
const FONT = "12px system-ui, sans-serif";

// The smallest round step with at most so many lines.
export function roundStep(range, lines) {
  const power = 10 ** Math.floor(Math.log10(range / lines));
  return [...ROUND, 10].map((n) => n * power).find((step) => range / step <= lines) ?? 10 * power;
}

const TIMES_S = [1, 5, 10, 30, 60, 120, 300, 600, 1800, 3600, 7200, 21600, 86400];

// The scale: from a round number below to one above; at least `least` high.
function scaleOf({ series, least, fromZero, most = Infinity }) {
  const values = series.flatMap(({ values: own }) => own.filter((one) => one !== null));
  let [low, high] = [Math.min(...values), Math.max(...values)];
  if (fromZero) low = Math.min(0, low);
  if (high - low < least) [low, high] = fromZero ? [low, low + least] : [(low + high - least) / 2, (low + high + least) / 2];
  if (high > most) [low, high] = [Math.min(low, most - least), most];
  const step = roundStep(high - low, LINES);
  return { low: Math.floor(low / step + 1e-9) * step, high: Math.min(Math.ceil(high / step - 1e-9) * step, most), step };
}

// graph: {title, unit, digits, series: [{name, values, isDashed}], least, most, fromZero}. In pixels of a canvas of this size.
export function drawGraph(pen, graph, times, marks, width, height, chosen) {
  const [colour, night] = [colours(), isNight()];
  const scale = scaleOf(graph);
  const [wide, high] = [width - PAD.left - PAD.right, height - PAD.top - PAD.bottom];
  const end_s = Math.max(times[times.length - 1], 1);
  const x = (at_s) => PAD.left + (at_s / end_s) * wide;
  const y = (value) => PAD.top + (1 - (value - scale.low) / (scale.high - scale.low)) * high;
  pen.fillStyle = colour.card;
  pen.fillRect(0, 0, width, height);
  pen.font = FONT;
  pen.lineWidth = 1;
  pen.strokeStyle = colour.grid;
  pen.fillStyle = colour.ink;
  pen.textBaseline = "middle";
  pen.textAlign = "right";
  const line = (...points) => {
    pen.beginPath();
    points.forEach(([px, py], n) => (n === 0 ? pen.moveTo(px, py) : pen.lineTo(px, py)));
    pen.stroke();
  };
  const digits = scale.step < 0.1 ? 2 : scale.step < 1 ? 1 : 0;
  for (let value = scale.low; value <= scale.high + scale.step / 2; value += scale.step) {
    line([PAD.left, y(value)], [width - PAD.right, y(value)]);
    pen.fillText(value.toFixed(digits), PAD.left - 6, y(value));
  }
  pen.textAlign = "center";
  const every_s = TIMES_S.find((one) => end_s / one <= Math.max(wide / 70, 2)) ?? 86400;
  for (let at_s = 0; at_s <= end_s; at_s += every_s) {
    line([x(at_s), PAD.top], [x(at_s), height - PAD.bottom]);
    if (x(at_s) < width - 24) pen.fillText(clock(at_s), x(at_s), height - 9);
  }
  pen.textAlign = "left";
  pen.font = "600 13px system-ui, sans-serif";
  pen.fillText(graph.title, 6, 10);
  pen.strokeStyle = colour.soft;
  pen.setLineDash([2, 3]);
  for (const at_s of marks) line([x(at_s), PAD.top], [x(at_s), height - PAD.bottom]);
  graph.series.forEach(({ values, isDashed }, n) => {
    pen.setLineDash(isDashed ? [6, 4] : []);
    pen.lineWidth = isDashed ? 1.5 : 2;
    pen.strokeStyle = n === 0 ? colour.track : night ? "#ffab73" : "#b3470b";
    pen.beginPath();
    let isDown = false;
    values.forEach((value, at) => {
      if (value === null) isDown = false;
      else if (isDown) pen.lineTo(x(times[at]), y(value));
      else pen.moveTo(x(times[at]), y(value));
      isDown = value !== null;
    });
    pen.stroke();
  });
  pen.setLineDash([]);
  if (chosen === null) return;
  pen.lineWidth = 2;
  pen.strokeStyle = colour.ink;
  line([x(times[chosen]), PAD.top - 4], [x(times[chosen]), height - PAD.bottom]);
  graph.series.forEach(({ values }) => {
    if (values[chosen] === null) return;
    pen.beginPath();
    pen.arc(x(times[chosen]), y(values[chosen]), 5, 0, 2 * Math.PI);
    pen.fillStyle = colour.card;
    pen.fill();
    pen.stroke();
  });
}

// choose(index); tellOf(index): the moment in words. Returns {box, show(index)}.
export function makeGraph(graph, voyage, marks, choose, tellOf) {
  const times = voyage.times_s;
  const canvas = element("canvas", {
    className: "graph", tabindex: 0, role: "slider", "aria-label": graph.title, "aria-valuemin": 0, "aria-valuemax": times.length - 1,
    "aria-valuenow": 0, "aria-valuetext": tellOf(0),
  });
  const pen = canvas.getContext("2d");
  let chosen = null;
  let frame = 0;
  const draw = () => {
    frame = 0;
    const [width, height] = [canvas.clientWidth, canvas.clientHeight];
    if (width <= 1) return;
    const density = sharpened(canvas, width, height);
    pen.setTransform(density, 0, 0, density, 0, 0);
    drawGraph(pen, graph, times, marks, width, height, chosen);
  };
  const changed = () => {
    if (frame === 0) frame = requestAnimationFrame(draw);
  };
  const at = (event) => {
    const box = canvas.getBoundingClientRect();
    const wide = box.width - PAD.left - PAD.right;
    const share = Math.min(Math.max((event.clientX - box.left - PAD.left) / wide, 0), 1);
    choose(nearest(times, share * times[times.length - 1]));
  };
  canvas.addEventListener("pointerdown", (event) => {
    canvas.setPointerCapture(event.pointerId);
    at(event);
  });
  canvas.addEventListener("pointermove", (event) => event.buttons !== 0 && at(event));
  canvas.addEventListener("keydown", (event) => {
    const last = times.length - 1;
    const pages = event.key.startsWith("Page") ? 10 : 100;
    const step = Math.max(1, Math.round(last / pages / (event.shiftKey ? 10 : 1)));
    if (event.key === "Home") choose(0);
    else if (event.key === "End") choose(last);
    else if (event.key in KEYS) choose(Math.min(Math.max((chosen ?? 0) + Math.sign(KEYS[event.key]) * step, 0), last));
    else return;
    event.preventDefault();
  });
  new ResizeObserver(changed).observe(canvas);
  whenLight(canvas, changed);
  return {
    box: canvas,
    show(index) {
      chosen = index;
      canvas.setAttribute("aria-valuenow", String(index));
      canvas.setAttribute("aria-valuetext", tellOf(index));
      changed();
    },
  };
}

// The index of the time that is nearest; times rise.
export function nearest(times, at_s) {
  let [low, high] = [0, times.length - 1];
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (times[middle] <= at_s) low = middle;
    else high = middle;
  }
  return at_s - times[low] <= times[high] - at_s ? low : high;
}
