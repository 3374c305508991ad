// The boat, what its sonar hears, the obstacles it knows of; scale bar, north and current. In pixels.
import { overlaps, text } from "./chart-map.js";

const HULL_M = 1.2;
const HULL_PX = 34; // at least
const ECHO_PX = 46; // a sweep without an echo is drawn so long, or as far as 10 m
const LEAST_CURRENT_M_S = 0.05; // less is shown as 0.0, and its direction is noise
const radians = (degrees) => (degrees * Math.PI) / 180;

export function drawSenses(pen, state, at, view, colour) {
  const heading = state.heading_deg;
  if (heading === null || heading === undefined) return;
  const { sonar, obstacles } = state;
  if (obstacles) {
    const { start_deg, step_deg, ranges_m } = obstacles;
    ranges_m.forEach((range_m, n) => {
      if (range_m === null || range_m <= 0) return;
      const middle = heading + start_deg + n * step_deg;
      const [from, to] = [turned(middle - step_deg / 2), turned(middle + step_deg / 2)];
      pen.beginPath();
      pen.arc(...at, range_m * view.scale, Math.min(from, to), Math.max(from, to));
      pen.lineWidth = 5;
      pen.lineCap = "butt";
      pen.strokeStyle = colour.obstacle;
      pen.stroke();
    });
  }
  if (sonar) {
    const middle = heading + sonar.bearing_deg;
    const half = Math.max(sonar.beam_deg / 2, 1);
    const hasEcho = sonar.range_m !== null && sonar.range_m !== undefined;
    const reach = hasEcho ? sonar.range_m * view.scale : Math.max(10 * view.scale, ECHO_PX);
    pen.beginPath();
    pen.moveTo(...at);
    pen.arc(...at, reach, turned(middle - half), turned(middle + half));
    pen.closePath();
    pen.globalAlpha = hasEcho ? 1 : 0.5;
    pen.fillStyle = colour.echo;
    pen.fill();
    pen.globalAlpha = 1;
    if (hasEcho) {
      pen.beginPath();
      pen.arc(...at, reach, turned(middle - half), turned(middle + half));
      pen.lineWidth = 3;
      pen.strokeStyle = colour.echoEdge;
      pen.stroke();
    }
  }
}

// isHeard: one that is not is grey and dashed, and shows no course.
export function drawBoat(pen, state, at, view, colour, isHeard) {
  const { heading_deg, course_deg, speed_m_s } = state;
  if (isHeard && course_deg !== null && course_deg !== undefined && speed_m_s > 0.15) {
    const long = Math.max(speed_m_s * 10 * view.scale, HULL_PX); // where it is in 10 s
    const [dx, dy] = [Math.sin(radians(course_deg)), -Math.cos(radians(course_deg))];
    for (const [width, ink] of [[4, colour.halo], [2, colour.hullEdge]]) {
      pen.beginPath();
      pen.moveTo(...at);
      pen.lineTo(at[0] + long * dx, at[1] + long * dy);
      pen.lineWidth = width;
      pen.strokeStyle = ink;
      pen.stroke();
    }
  }
  drawHull(pen, heading_deg, at, view, colour, !isHeard ? colour.unheard : state.armed ? colour.route : colour.hull, !isHeard);
}

// Another boat: grey, with its name.
export function drawOther(pen, { name, heading_deg }, at, view, colour) {
  drawHull(pen, heading_deg, at, view, colour, colour.unheard, false);
  pen.font = "600 13px system-ui, sans-serif";
  text(pen, name, at[0], at[1] + HULL_PX / 2 + 12, colour.ink, colour.halo);
}

// A vessel with AIS: its hull as long as it is, where it will be in a minute, and how near it comes (CPA) and when, in
// metres east and north. taken: boxes of pixels where its words may not stand; where there is no room, they are left out.
export function drawVessel(pen, vessel, boat, metres, view, colour, words, taken) {
  const [at, way] = [metres, wayOf(vessel, 60)];
  const pixel = view.toPixel(at);
  pen.beginPath();
  pen.moveTo(...pixel);
  pen.lineTo(...view.toPixel([at[0] + way[0], at[1] + way[1]]));
  pen.lineWidth = 2;
  pen.strokeStyle = colour.vessel;
  pen.stroke();
  drawHull(pen, vessel.heading_deg, pixel, view, colour, colour.vessel, false, vessel.length_m ?? 0);
  const said = [vessel.name, vessel.speed_m_s == null ? "" : words.speed(vessel.speed_m_s), closest(vessel, at, boat, words)];
  pen.font = "600 13px system-ui, sans-serif";
  const below = Math.max((vessel.length_m ?? 0) * view.scale, HULL_PX) / 2 + 12;
  const label = said.filter(Boolean).join(" \u00B7 ");
  const half = pen.measureText(label).width / 2 + 2;
  const places = [[0, below], [0, -below], [half + below, 0], [-half - below, 0]].map(([x, y]) => [pixel[0] + x, pixel[1] + y]);
  const boxOf = ([x, y]) => [x - half, y - 8, x + half, y + 8];
  const free = places.find((place) => !taken.some((other) => overlaps(boxOf(place), other)));
  if (free === undefined) return;
  taken.push(boxOf(free));
  text(pen, label, ...free, colour.ink, colour.halo);
}

const wayOf = ({ course_deg, speed_m_s }, seconds) =>
  [Math.sin, Math.cos].map((part) => (course_deg == null ? 0 : seconds * (speed_m_s ?? 0) * part(radians(course_deg))));

// Within ten minutes, if both go straight on; empty if they do not come nearer.
function closest(vessel, at, boat, words) {
  if (boat === null) return "";
  const [from, way] = [[0, 1].map((n) => at[n] - boat.at[n]), [0, 1].map((n) => wayOf(vessel, 1)[n] - wayOf(boat.state, 1)[n])];
  const when_s = -(from[0] * way[0] + from[1] * way[1]) / Math.max(way[0] ** 2 + way[1] ** 2, 1e-6);
  if (!(when_s > 0 && when_s < 600)) return "";
  return `CPA ${words.distance(Math.hypot(from[0] + when_s * way[0], from[1] + when_s * way[1]))}, ${words.duration(when_s)}`;
}

function drawHull(pen, heading_deg, at, view, colour, fill, isDashed, length_m = HULL_M) {
  pen.save();
  pen.translate(...at);
  pen.beginPath();
  if (heading_deg === null || heading_deg === undefined) pen.arc(0, 0, 9, 0, 2 * Math.PI);
  else {
    pen.rotate(radians(heading_deg));
    const half = Math.max(length_m * view.scale, HULL_PX) / 2;
    const beam = 0.42 * half;
    pen.moveTo(0, -half);
    pen.bezierCurveTo(beam, -0.45 * half, beam, 0, 0.85 * beam, half);
    pen.lineTo(-0.85 * beam, half);
    pen.bezierCurveTo(-beam, 0, -beam, -0.45 * half, 0, -half);
    pen.closePath();
  }
  pen.lineJoin = "round";
  pen.lineWidth = 6;
  pen.strokeStyle = colour.halo;
  pen.stroke();
  pen.fillStyle = fill;
  pen.fill();
  pen.lineWidth = 2.5;
  pen.strokeStyle = colour.hullEdge;
  if (isDashed) pen.setLineDash([5, 4]);
  pen.stroke();
  pen.restore();
}

// The largest round length of at most so many pixels.
export function roundLength(pixels, scale) {
  const most = pixels / scale;
  const power = 10 ** Math.floor(Math.log10(most));
  return [5, 2, 1].map((n) => n * power).find((n) => n <= most) ?? power;
}

export function drawScale(pen, view, colour, words) {
  const length_m = roundLength(Math.min(110, view.width / 3), view.scale);
  const long = length_m * view.scale;
  const [x, y] = [14, view.height - 16];
  for (const [width, ink] of [[6, colour.halo], [2.5, colour.ink]]) {
    pen.beginPath();
    pen.moveTo(x, y - 7);
    pen.lineTo(x, y);
    pen.lineTo(x + long, y);
    pen.lineTo(x + long, y - 7);
    pen.lineWidth = width;
    pen.strokeStyle = ink;
    pen.stroke();
  }
  pen.font = "600 13px system-ui, sans-serif";
  text(pen, words.distance(length_m), x + long / 2, y - 14, colour.ink, colour.halo);
}

export function drawNorth(pen, colour, words) {
  arrow(pen, [24, 34], 0, colour.ink, colour.halo, 13);
  pen.font = "700 14px system-ui, sans-serif";
  text(pen, words.say("chart.north"), 24, 12, colour.ink, colour.halo);
}

// {said, half}: half of its width in pixels; null where there is no current to speak of.
function currentText(pen, current, words) {
  if (!current || current.speed_m_s < LEAST_CURRENT_M_S) return null;
  pen.font = "600 13px system-ui, sans-serif";
  const said = words.say("chart.current", { speed: words.speed(current.speed_m_s) });
  return { said, half: pen.measureText(said).width / 2 };
}

// The arrow flies with the water.
export function drawCurrent(pen, current, colour, words) {
  const told = currentText(pen, current, words);
  if (told === null) return;
  arrow(pen, [24, 76], current.towards_deg, colour.track, colour.halo, 15);
  text(pen, told.said, 44 + told.half, 76, colour.ink, colour.halo);
}

// What the current's text covers: no name is drawn there.
export function currentRoom(pen, current, words) {
  const told = currentText(pen, current, words);
  return told === null ? [] : [[44, 66, 44 + 2 * told.half, 86]];
}

function arrow(pen, at, towards_deg, ink, halo, half) {
  pen.save();
  pen.translate(...at);
  pen.rotate(radians(towards_deg));
  pen.beginPath();
  pen.moveTo(0, -half);
  pen.lineTo(half * 0.62, -half * 0.1);
  pen.lineTo(half * 0.22, -half * 0.1);
  pen.lineTo(half * 0.22, half);
  pen.lineTo(-half * 0.22, half);
  pen.lineTo(-half * 0.22, -half * 0.1);
  pen.lineTo(-half * 0.62, -half * 0.1);
  pen.closePath();
  pen.lineJoin = "round";
  pen.lineWidth = 4;
  pen.strokeStyle = halo;
  pen.stroke();
  pen.fillStyle = ink;
  pen.fill();
  pen.restore();
}

const turned = (bearing_deg) => radians(bearing_deg - 90); // clockwise from the canvas' x axis
