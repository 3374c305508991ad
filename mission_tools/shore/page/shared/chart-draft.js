// What is being planned: places with their numbers, an area, and the line of the plan. In pixels.
import { drawWay } from "./chart-plan.js";

const TIP_PX = 16; // from a goal's tip to the middle of its head
const HEAD_PX = 13;
const CORNER_PX = 11;
const MANY = 40; // points of a line: the tracks of a survey

// draft: {places, isArea, line}, all as [lon, lat]; pixel: of a place.
export function drawDraft(pen, draft, pixel, colour) {
  const places = draft.places.map(pixel);
  if (draft.isArea) outline(pen, places, colour);
  if (draft.line.length > 1) drawWay(pen, draft.line.map(pixel), colour, draft.line.length > MANY);
  places.forEach((at, n) => {
    if (draft.isArea) corner(pen, at, colour);
    else goal(pen, at, colour);
    const [x, y] = draft.isArea ? at : [at[0], at[1] - TIP_PX];
    pen.font = `700 ${n < 9 ? 14 : 12}px system-ui, sans-serif`;
    pen.textAlign = "center";
    pen.textBaseline = "middle";
    pen.fillStyle = colour.card;
    pen.fillText(String(n + 1), x, y + 0.5);
  });
}

// Where no name is written.
export const draftRoom = (draft, pixel) =>
  draft.places.map(pixel).map(([x, y]) => [x - HEAD_PX, y - TIP_PX - HEAD_PX, x + HEAD_PX, y + CORNER_PX]);

// The tip is on the place.
function goal(pen, [x, y], colour) {
  pen.beginPath();
  pen.moveTo(x, y);
  pen.arc(x, y - TIP_PX, HEAD_PX, 0.8 * Math.PI, 0.2 * Math.PI);
  pen.closePath();
  filled(pen, colour);
}

function corner(pen, [x, y], colour) {
  pen.beginPath();
  pen.rect(x - CORNER_PX, y - CORNER_PX, 2 * CORNER_PX, 2 * CORNER_PX);
  filled(pen, colour);
}

function filled(pen, colour) {
  pen.lineJoin = "round";
  pen.lineWidth = 5;
  pen.strokeStyle = colour.halo;
  pen.stroke();
  pen.fillStyle = colour.track;
  pen.fill();
}

function outline(pen, corners, colour) {
  if (corners.length < 2) return;
  pen.beginPath();
  corners.forEach(([x, y], n) => (n === 0 ? pen.moveTo(x, y) : pen.lineTo(x, y)));
  pen.closePath();
  pen.globalAlpha = 0.16;
  pen.fillStyle = colour.track;
  pen.fill();
  pen.globalAlpha = 1;
  for (const [width, ink] of [[6, colour.halo], [2.5, colour.track]]) {
    pen.lineWidth = width;
    pen.lineJoin = "round";
    pen.strokeStyle = ink;
    pen.stroke();
  }
}
