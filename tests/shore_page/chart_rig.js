// The chart alone, with its draws counted and its taps kept.
import { makeChart } from "/page/shared/chart.js";

const words = {
  say: (key, values = {}) =>
    ({ "chart.north": "N", "chart.home": "H", "chart.rally": "R", "chart.current": `Current ${values.speed}` })[key] ?? key,
  distance: (metres) => (metres < 1000 ? `${Math.round(metres)} m` : `${metres / 1000} km`),
  duration: (seconds) => `${Math.round(seconds)} s`,
  speed: (speed) => `${speed.toFixed(1)} m/s`,
};
window.draws = 0;
window.taps = [];
const fillRect = CanvasRenderingContext2D.prototype.fillRect;
CanvasRenderingContext2D.prototype.fillRect = function (...box) {
  if (box[0] === 0 && box[1] === 0) window.draws += 1; // each drawing begins with the whole canvas
  fillRect.apply(this, box);
};
window.chart = makeChart(document.getElementById("chart"), words);
window.chart.onTap((lat, lon) => window.taps.push([lat, lon]));
