// The voyage as a PNG: its figures, the track with its legend, and the graphs.
import { colours, isNight } from "../shared/chart-colours.js";
import { drawGraph } from "./graph.js";
import { inkOf } from "./speed.js";
import { drawWhole } from "./track.js";
import { figures } from "./words.js";

const [WIDE, TRACK, GRAPH, HEAD, LEGEND] = [1000, 640, 170, 64, 36];
const DENSITY = 2;

export function savePicture(name, title, voyage, track, graphs, marks, words) {
  const canvas = document.createElement("canvas");
  canvas.width = WIDE * DENSITY;
  canvas.height = (HEAD + TRACK + LEGEND + GRAPH * graphs.length) * DENSITY;
  const pen = canvas.getContext("2d");
  drawWhole(pen, voyage, track, WIDE, TRACK, DENSITY, words);
  const picture = pen.getImageData(0, 0, WIDE * DENSITY, TRACK * DENSITY);
  pen.setTransform(1, 0, 0, 1, 0, 0);
  pen.putImageData(picture, 0, HEAD * DENSITY);
  pen.setTransform(DENSITY, 0, 0, DENSITY, 0, 0);
  const colour = colours();
  const paper = (top, height) => {
    pen.fillStyle = colour.card;
    pen.fillRect(0, top, WIDE, height);
    pen.fillStyle = colour.ink;
    pen.textAlign = "left";
    pen.textBaseline = "middle";
  };
  paper(0, HEAD);
  pen.font = "700 20px system-ui, sans-serif";
  pen.fillText(title, 12, 20);
  pen.font = "15px system-ui, sans-serif";
  pen.fillText(figures(voyage, words).map(([key, value]) => `${words.say(key)} ${value}`).join("   "), 12, 46, WIDE - 24);
  paper(HEAD + TRACK, LEGEND);
  voyage.steps.forEach(({ from, to, width }, n) => {
    const [x, y] = [12 + n * 150, HEAD + TRACK + LEGEND / 2];
    pen.strokeStyle = inkOf(n, isNight());
    pen.lineWidth = width;
    pen.beginPath();
    pen.moveTo(x, y);
    pen.lineTo(x + 34, y);
    pen.stroke();
    pen.fillText(words.say("logs.from_to", { from: words.number(from, 1), to: words.number(to, 1) }), x + 42, y);
  });
  graphs.forEach((graph, n) => {
    pen.setTransform(DENSITY, 0, 0, DENSITY, 0, (HEAD + TRACK + LEGEND + n * GRAPH) * DENSITY);
    drawGraph(pen, graph, voyage.times_s, marks, WIDE, GRAPH, null);
  });
  canvas.toBlob((blob) => {
    const link = document.createElement("a");
    link.href = URL.createObjectURL(blob);
    link.download = `${name}.png`;
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
  }, "image/png");
}
