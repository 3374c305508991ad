// What is being planned: places, options and the latest result. Kept over a reload of the page.
import { Plane } from "../shared/chart-view.js";

const STORED = "mavboat.plan";
const MOST_STEPS = 50; // that can be undone
export const MOST_PLACES = 100; // as the server takes

// Numbers of the planner; an empty one is left to it. most: what makes sense, the planner says the rest.
// share: of the unit shown.
export const FIELDS = [
  { name: "clearance_m", label: "plan.clearance_m", least: 0, most: 100, tasks: ["route", "survey"] },
  { name: "speed_m_s", label: "plan.speed_m_s", least: 0.1, most: 10, tasks: ["route", "survey"] },
  { name: "wind_m_s", label: "plan.wind_m_s", least: 0, most: 40, tasks: ["route", "survey"] },
  { name: "wind_from_deg", label: "plan.wind_from_deg", least: 0, most: 360, tasks: ["route", "survey"] },
  { name: "footprint_m", label: "plan.footprint_m", least: 0.1, most: 1000, tasks: ["survey"], isNeeded: true },
  { name: "overlap", label: "plan.overlap", least: 0, most: 90, share: 100, tasks: ["survey"] },
  { name: "angle_deg", label: "plan.angle_deg", least: 0, most: 360, tasks: ["survey"] },
];
export const SWITCHES = [
  { name: "any_order", label: "plan.any_order", tasks: ["route"] },
  { name: "return", label: "plan.return", tasks: ["route"] },
];

export class Draft {
  constructor(store = sessionStorage) {
    this.store = store;
    this.task = "route";
    this.places = { route: [], survey: [] }; // goals, and corners of an area: [lon, lat]
    this.options = {}; // as typed
    this.result = null; // the server's answer, and of what: {…, boat, asked}
    this.undone = [];
    this.#load();
  }

  get here() {
    return this.places[this.task];
  }

  // Replaces the places of the task.
  change(places) {
    this.undone = [...this.undone.slice(1 - MOST_STEPS), { task: this.task, places: this.here }];
    this.places = { ...this.places, [this.task]: places };
    this.save();
  }

  undo() {
    const last = this.undone.pop();
    if (last === undefined) return false;
    this.task = last.task;
    this.places = { ...this.places, [last.task]: last.places };
    this.save();
    return true;
  }

  // What the server is asked for. Only valid while `fault` is null.
  request() {
    const numbers = FIELDS.map(({ name, share = 1, tasks }) => {
      const text = String(this.options[name] ?? "").trim();
      return [name, text === "" || !tasks.includes(this.task) ? null : Number(text) / share];
    });
    const switches = SWITCHES.map(({ name, tasks }) => [name, tasks.includes(this.task) && this.options[name] === true]);
    return {
      task: this.task,
      start: null, // the boat's place
      goals: this.task === "route" ? this.here : [],
      area: this.task === "survey" ? this.here : [],
      ...Object.fromEntries([...switches, ...numbers]),
    };
  }

  // Why it cannot be planned: {key, values, field}, or null.
  fault() {
    if (this.task === "route" && this.here.length === 0) return { key: "plan.no_goal" };
    if (this.task === "survey" && [1, 2].includes(this.here.length)) return { key: "plan.few_corners" };
    for (const field of FIELDS) {
      if (!field.tasks.includes(this.task)) continue;
      const text = String(this.options[field.name] ?? "").trim();
      const value = Number(text);
      if (text === "" && field.isNeeded) return { key: "plan.needed", field };
      if (text === "" || (value >= field.least && value <= field.most)) continue;
      return { key: "plan.bad_number", values: { text, least: field.least, most: field.most }, field };
    }
    return null;
  }

  // Whether the result belongs to what is drawn now; an imported one always does.
  isCurrent(boat) {
    return this.result !== null && this.result.boat === boat && (this.result.asked === null || this.result.asked === JSON.stringify(this.request()));
  }

  save() {
    const { task, places, options, result, undone } = this;
    try {
      this.store.setItem(STORED, JSON.stringify({ task, places, options, result, undone }));
    } catch {
      // no room, or not allowed: it lives as long as the page
    }
  }

  #load() {
    try {
      const { task, places, options, result, undone } = JSON.parse(this.store.getItem(STORED));
      if (![places.route, places.survey, undone].every(Array.isArray) || !["route", "survey"].includes(task)) return;
      Object.assign(this, { task, places, options, result, undone });
    } catch {
      // nothing kept
    }
  }
}

const far = (a, b) => Math.hypot(...new Plane(...a).to(b));

// Metres from each place to the next; from: the first is measured from here, or null.
export const legs = (places, from) => places.map((place, n) => (n > 0 ? far(places[n - 1], place) : from && far(from, place)));

// Of the polygon, m².
export function area(corners) {
  if (corners.length < 3) return 0;
  const plane = new Plane(...corners[0]);
  const points = corners.map((corner) => plane.to(corner));
  const twice = points.reduce((sum, [x, y], n) => {
    const [e, k] = points[(n + 1) % points.length];
    return sum + x * k - e * y;
  }, 0);
  return Math.abs(twice) / 2;
}
