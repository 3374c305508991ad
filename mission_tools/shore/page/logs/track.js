// The track of a voyage over the chart: coloured by speed, with what happened on the way. Moved and zoomed like the chart.
import { drawNorth, drawScale, roundLength } from "../shared/chart-boat.js";
import { colours, isNight } from "../shared/chart-colours.js";
import { listen } from "../shared/chart-input.js";
import { drawGrid, drawMap, drawNames, prepare, text } from "../shared/chart-map.js";
import { drawCross } from "../shared/chart-plan.js";
import { Plane, View } from "../shared/chart-view.js";
import { element } from "../shared/elements.js";
import { sharpened, whenLight } from "./canvas.js";
import { inkOf, stepOf } from "./speed.js";

const SHARE = 0.84; // of the canvas that the track takes at first
const LEAST_M = 12; // shown at least
const TAP_PX = 40; // a tap farther from the track means nothing
const TURN = 2 * Math.PI;

// The voyage as it is drawn: in metres round its first place, on the map of the water.
export function prepareTrack(voyage, geojson) {
  const plane = new Plane(...voyage.track[0]);
  const points = voyage.track.map((place) => plane.to(place));
  const bounds = points.reduce(
    ([w, s, e, n], [x, y]) => [Math.min(w, x), Math.min(s, y), Math.max(e, x), Math.max(n, y)],
    [-LEAST_M / 2, -LEAST_M / 2, LEAST_M / 2, LEAST_M / 2],
  );
  return { plane, points, bounds, map: prepare(geojson, plane) };
}

// In pixels; density: of the canvas.
export function drawVoyage(pen, voyage, track, view, density, chosen, words) {
  const [colour, night] = [colours(), isNight()];
  const isCharted = track.map.bounds !== null;
  pen.setTransform(density, 0, 0, density, 0, 0);
  pen.fillStyle = isCharted ? colour.land : colour.water;
  pen.fillRect(0, 0, view.width, view.height);
  if (isCharted) {
    const [scale, [x, y]] = [density * view.scale, view.toPixel([0, 0])];
    pen.setTransform(scale, 0, 0, -scale, density * x, density * y);
    drawMap(pen, track.map, view, colour, 1 / view.scale);
    pen.setTransform(density, 0, 0, density, 0, 0);
  } else drawGrid(pen, view, colour, roundLength(90, view.scale));
  const taken = [[0, 0, 48, 60], [0, view.height - 40, 140, view.height]];
  const pixels = track.points.map((point) => view.toPixel(point));
  drawLine(pen, voyage, pixels, colour, night);
  for (const event of voyage.events) drawEvent(pen, event, pixels[event.place], view, colour, taken, words);
  drawEnd(pen, pixels[0], colour, words.say("logs.start"), true);
  drawEnd(pen, pixels[pixels.length - 1], colour, words.say("logs.end"), false);
  if (isCharted) drawNames(pen, track.map, view, colour, taken);
  if (chosen !== null) {
    const at = pixels[chosen];
    for (const [width, ink] of [[7, colour.halo], [3, colour.ink]]) {
      pen.beginPath();
      pen.arc(...at, 12, 0, TURN);
      pen.moveTo(at[0] - 20, at[1]);
      pen.lineTo(at[0] + 20, at[1]);
      pen.moveTo(at[0], at[1] - 20);
      pen.lineTo(at[0], at[1] + 20);
      pen.lineWidth = width;
      pen.strokeStyle = ink;
      pen.stroke();
    }
  }
  drawScale(pen, view, colour, words);
  drawNorth(pen, colour, words);
}

function drawLine(pen, voyage, pixels, colour, night) {
  pen.lineJoin = pen.lineCap = "round";
  const pieces = [];
  pixels.forEach((at, n) => {
    if (n === 0) return;
    const last = pieces[pieces.length - 1];
    const step = stepOf(voyage.steps, voyage.speeds_m_s[n], last?.step ?? null);
    if (last?.step === step) last.points.push(at);
    else pieces.push({ step, points: [pixels[n - 1], at] });
  });
  for (const isHalo of [true, false])
    for (const { step, points } of pieces) {
      pen.beginPath();
      points.forEach(([x, y], n) => (n === 0 ? pen.moveTo(x, y) : pen.lineTo(x, y)));
      pen.lineWidth = voyage.steps[step ?? 0].width + (isHalo ? 3 : 0);
      pen.strokeStyle = isHalo ? colour.halo : inkOf(step, night);
      pen.stroke();
    }
  pen.lineCap = "butt";
}

// Modes are diamonds with their names, errors are triangles.
function drawEvent(pen, event, at, view, colour, taken, words) {
  if (event.kind !== "mode" && event.kind !== "error") return;
  const isError = event.kind === "error";
  const [x, y] = at;
  pen.beginPath();
  if (isError) [[x, y - 9], [x + 9, y + 7], [x - 9, y + 7]].forEach((corner, n) => (n === 0 ? pen.moveTo(...corner) : pen.lineTo(...corner)));
  else [[x, y - 8], [x + 8, y], [x, y + 8], [x - 8, y]].forEach((corner, n) => (n === 0 ? pen.moveTo(...corner) : pen.lineTo(...corner)));
  pen.closePath();
  pen.fillStyle = isError ? colour.keep : colour.card;
  pen.fill();
  pen.lineWidth = 2;
  pen.strokeStyle = isError ? colour.halo : colour.ink;
  pen.stroke();
  pen.font = "600 12px system-ui, sans-serif";
  const name = isError ? event.text : words.sayOr(`mode.${event.text}`, event.text);
  const half = pen.measureText(name).width / 2 + 3;
  const middle = Math.min(Math.max(x, half), view.width - half); // whole where it is at the edge
  const own = [middle - half, y - 28, middle + half, y - 10];
  if (taken.some((other) => own[0] < other[2] && own[2] > other[0] && own[1] < other[3] && own[3] > other[1])) return;
  taken.push(own);
  text(pen, name, middle, y - 19, isError ? colour.keep : colour.ink, colour.halo);
}

function drawEnd(pen, [x, y], colour, name, isStart) {
  pen.beginPath();
  if (isStart) pen.arc(x, y, 7, 0, TURN);
  else pen.rect(x - 6, y - 6, 12, 12);
  pen.fillStyle = colour.card;
  pen.fill();
  pen.lineWidth = 3;
  pen.strokeStyle = colour.ink;
  pen.stroke();
  pen.font = "700 13px system-ui, sans-serif";
  text(pen, name, x, y + 19, colour.ink, colour.halo);
}

// choose(index): a place of the track was tapped. Returns {box, show(index), fit(view)}.
export function makeTrack(voyage, geojson, words, choose) {
  const track = prepareTrack(voyage, geojson);
  const canvas = element("canvas", { className: "track", tabindex: 0, role: "application", "aria-label": words.say("logs.track") });
  const pen = canvas.getContext("2d");
  const view = new View();
  let chosen = null;
  let frame = 0;

  const draw = () => {
    frame = 0;
    if (view.width <= 1) return; // hidden
    drawVoyage(pen, voyage, track, view, sharpened(canvas, view.width, view.height), chosen, words);
    if (canvas.matches(":focus-visible")) drawCross(pen, view, colours());
  };
  const changed = () => {
    if (frame === 0) frame = requestAnimationFrame(draw);
  };
  const middle = () => [view.width / 2, view.height / 2];
  listen(canvas, {
    pan: (dx, dy) => (view.pan(dx, dy), changed()),
    zoom: (factor, at) => (view.zoom(factor, at), changed()),
    tap: (at) => {
      const away = track.points.map((point) => {
        const [x, y] = view.toPixel(point);
        return Math.hypot(x - at[0], y - at[1]);
      });
      const nearest = away.indexOf(Math.min(...away));
      if (away[nearest] <= TAP_PX) choose(nearest);
    },
    follow: () => (view.fit(track.bounds, SHARE), changed()),
    middle,
  });
  for (const name of ["focus", "blur"]) canvas.addEventListener(name, changed);
  new ResizeObserver(() => {
    const isFirst = view.width === 1;
    [view.width, view.height] = [Math.max(canvas.clientWidth, 1), Math.max(canvas.clientHeight, 1)];
    if (isFirst) view.fit(track.bounds, SHARE);
    changed();
  }).observe(canvas);
  whenLight(canvas, changed);

  return {
    box: canvas,
    track,
    show(index) {
      chosen = index;
      changed();
    },
  };
}

// The same picture on another canvas, from (0, 0) to the width and height.
export function drawWhole(pen, voyage, track, width, height, density, words) {
  const view = new View();
  [view.width, view.height] = [width, height];
  view.fit(track.bounds, SHARE);
  pen.save();
  pen.beginPath();
  pen.rect(0, 0, width * density, height * density);
  pen.clip();
  drawVoyage(pen, voyage, track, view, density, null, words);
  pen.restore();
}
