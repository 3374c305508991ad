// What was planned and sailed: mission, fence, rally points, home, track, and a way that is offered. In pixels.
import { overlaps } from "./chart-map.js";

const OUTSIDE = [5002, 5004]; // MAVLink's numbers of exclusion areas
const RETURN_POINT = 5000;
const NOT_SAILED = [179, 195, 196, 197, 201]; // items with a place that is not sailed to: home, regions of interest
const SOME_PX = 22; // numbers nearer than this to another are dots

const sailed = (features) =>
  features.filter((one) => one.geometry?.type === "Point" && one.properties.seq > 0 && !NOT_SAILED.includes(one.properties.command));

export function drawTrack(pen, points, colour) {
  line(pen, points, colour.halo, 3.5, 0.6);
  line(pen, points, colour.track, 2);
}

export function drawFence(pen, features, plane, view, colour) {
  for (const { geometry, properties } of features) {
    if (!geometry) continue;
    pen.beginPath();
    if (geometry.type === "Polygon") {
      geometry.coordinates[0].forEach((place, n) => {
        const [x, y] = view.toPixel(plane.to(place));
        if (n === 0) pen.moveTo(x, y);
        else pen.lineTo(x, y);
      });
      pen.closePath();
    } else if (properties.radius_m && properties.command !== RETURN_POINT) {
      pen.arc(...view.toPixel(plane.to(geometry.coordinates)), properties.radius_m * view.scale, 0, 2 * Math.PI);
    } else continue;
    const isOut = OUTSIDE.includes(properties.command);
    if (isOut) {
      pen.globalAlpha = 0.22;
      pen.fillStyle = colour.keep;
      pen.fill();
      pen.globalAlpha = 1;
    }
    pen.setLineDash(isOut ? [3, 4] : [12, 5]);
    pen.lineWidth = 2.5;
    pen.strokeStyle = isOut ? colour.keep : colour.fence;
    pen.stroke();
    pen.setLineDash([]);
  }
}

// The items that are sailed to, with their pixels.
export const placed = (features, plane, view) =>
  sailed(features).map((one) => ({ ...one.properties, at: view.toPixel(plane.to(one.geometry.coordinates)) }));

export function drawMissionLine(pen, items, colour) {
  const points = items.map((item) => item.at);
  line(pen, points, colour.halo, 6, 0.75);
  line(pen, points, colour.route, 3);
}

export function drawMissionItems(pen, items, current, view, colour, taken) {
  for (const item of items) {
    if (item.command === 18 && item.radius_m) {
      pen.beginPath();
      pen.arc(...item.at, item.radius_m * view.scale, 0, 2 * Math.PI);
      pen.lineWidth = 2;
      pen.strokeStyle = colour.route;
      pen.stroke();
    }
  }
  // The present item takes its room first, then the ends, then the others in order
  const rank = (item) => (item.seq === current ? 0 : item === items[0] || item === items[items.length - 1] ? 1 : 2);
  for (const item of items.slice().sort((a, b) => rank(a) - rank(b))) {
    const [x, y] = item.at;
    const own = [x - SOME_PX / 2, y - SOME_PX / 2, x + SOME_PX / 2, y + SOME_PX / 2];
    const isSmall = item.seq !== current && taken.some((other) => overlaps(own, other));
    if (!isSmall) taken.push(own);
    pin(pen, [x, y], isSmall ? "" : String(item.seq), item.seq === current, colour);
  }
}

export function drawMark(pen, [x, y], letter, colour, isSquare) {
  pen.beginPath();
  if (isSquare) pen.rect(x - 10, y - 10, 20, 20);
  else {
    pen.moveTo(x, y - 14);
    pen.lineTo(x + 14, y);
    pen.lineTo(x, y + 14);
    pen.lineTo(x - 14, y);
    pen.closePath();
  }
  pen.fillStyle = colour.card;
  pen.fill();
  pen.lineWidth = 2.5;
  pen.strokeStyle = colour.ink;
  pen.stroke();
  letters(pen, letter, x, y, colour.ink);
}

// A way that is offered: dashes and a ring at its end, none of the other lines has them. Finer where its legs are close.
export function drawWay(pen, points, colour, isFine = false) {
  line(pen, points, colour.halo, isFine ? 4.5 : 7, 0.9);
  pen.setLineDash(isFine ? [7, 3] : [10, 7]);
  line(pen, points, colour.ink, isFine ? 2 : 3.5);
  pen.setLineDash([]);
  const [x, y] = points[points.length - 1];
  for (const [width, ink] of [[7, colour.halo], [3, colour.ink]]) {
    pen.beginPath();
    pen.arc(x, y, 11, 0, 2 * Math.PI);
    pen.lineWidth = width;
    pen.strokeStyle = ink;
    pen.stroke();
  }
}

export function drawCross(pen, view, colour) {
  const [x, y] = [view.width / 2, view.height / 2];
  for (const [width, ink] of [[5, colour.halo], [2, colour.ink]]) {
    pen.beginPath();
    for (const [dx, dy] of [[1, 0], [-1, 0], [0, 1], [0, -1]]) {
      pen.moveTo(x + 5 * dx, y + 5 * dy);
      pen.lineTo(x + 16 * dx, y + 16 * dy);
    }
    pen.lineWidth = width;
    pen.strokeStyle = ink;
    pen.stroke();
  }
}

function pin(pen, [x, y], number, isCurrent, colour) {
  pen.beginPath();
  pen.arc(x, y, number === "" ? 3.5 : isCurrent ? 13 : 10, 0, 2 * Math.PI);
  pen.fillStyle = isCurrent ? colour.route : colour.card;
  pen.fill();
  pen.lineWidth = 2;
  pen.strokeStyle = isCurrent ? colour.halo : colour.route;
  pen.stroke();
  letters(pen, number, x, y, isCurrent ? colour.card : colour.ink);
}

function letters(pen, words, x, y, colour) {
  pen.font = `700 ${words.length > 2 ? 9 : 12}px system-ui, sans-serif`;
  pen.textAlign = "center";
  pen.textBaseline = "middle";
  pen.fillStyle = colour;
  pen.fillText(words, x, y + 0.5);
}

function line(pen, points, colour, width, alpha = 1) {
  if (points.length < 2) return;
  pen.beginPath();
  points.forEach(([x, y], n) => (n === 0 ? pen.moveTo(x, y) : pen.lineTo(x, y)));
  pen.lineWidth = width;
  pen.lineJoin = pen.lineCap = "round";
  pen.strokeStyle = colour;
  pen.globalAlpha = alpha;
  pen.stroke();
  pen.globalAlpha = 1;
  pen.lineCap = "butt";
}

