// Sensors: each part of the boat with its values and a verdict. Asked for while the panel is open, and only then.
import { element, pair, setText } from "../shared/elements.js";
import { watchSensors } from "./sensor-feed.js";

export const title = "sensor.title";

const SIGNS = { fine: "✓", warning: "▲", failed: "✕", skipped: "–" };
const LEVELS = { fine: "good", warning: "warn", failed: "bad", skipped: "" };

// How a value is shown, by its name.
const FORMATS = {
  bearing_deg: (v, w) => w.say("unit.degrees", { n: w.number(v) }),
  cells_v: (v, w) => v.map((cell) => w.say("unit.v", { n: w.number(cell, 2) })).join(" "),
  channels_us: (v, w) => w.say("unit.us", { n: v.slice(0, 8).join(" ") }),
  current_a: (v, w) => w.say("unit.a", { n: w.number(v, 2) }),
  date_s: (v, w) => w.date(v),
  depth_m: (v, w) => w.say("unit.m", { n: w.number(v, 2) }),
  disk_mb: (v, w) => (v < 1000 ? w.say("unit.mb", { n: w.number(v) }) : w.say("unit.gb", { n: w.number(v / 1000, 1) })),
  doubt: (v, w) => w.percent(v),
  error_m: (v, w) => w.say("unit.m", { n: w.number(v, 2) }),
  field_mg: (v, w) => w.say("unit.mg", { n: w.number(v) }),
  fix: (v, w) => w.sayOr(`sensor.fix.${v}`, String(v)),
  hdop: (v, w) => w.number(v, 1),
  heading_deg: (v, w) => w.say("unit.degrees", { n: w.number(v) }),
  left_s: (v, w) => w.duration(v),
  left_us: (v, w) => w.say("unit.us", { n: String(v) }),
  load: (v, w) => w.percent(v),
  memory_mb: (v, w) => w.say("unit.mb", { n: w.number(v) }),
  percent: (v, w) => w.percent(v / 100),
  range_m: (v, w) => w.say("unit.m", { n: w.number(v, 2) }),
  rate_deg_s: (v, w) => w.say("unit.deg_s", { n: w.number(v, 1) }),
  reach_m: (v, w) => w.say("unit.m", { n: w.number(v, 1) }),
  right_us: (v, w) => w.say("unit.us", { n: String(v) }),
  running_s: (v, w) => w.duration(v),
  satellites: (v, w) => w.number(v),
  signal: (v, w) => w.percent(v),
  temperature_c: (v, w) => w.say("unit.celsius", { n: w.number(v) }),
  value: (v, w) => String(v),
  voltage_v: (v, w) => w.say("unit.v", { n: w.number(v, 2) }),
  water_c: (v, w) => w.say("unit.celsius", { n: w.number(v, 1) }),
};

export function makePanel(inside, page) {
  const { words } = page;
  const summary = element("p", { className: "sensor-summary", role: "status", text: words.say("sensor.waiting") });
  const list = element("ul", { className: "sensors" });
  inside.append(summary, list);
  const cards = new Map();

  const show = (sensors) => {
    if (sensors === null) {
      setText(summary, words.say("sensor.lost"));
      list.classList.add("old");
      return;
    }
    list.classList.remove("old");
    setText(summary, counted(sensors, words));
    for (const sensor of sensors) {
      if (!cards.has(sensor.name)) {
        const card = makeCard(sensor.name, words);
        cards.set(sensor.name, card);
        list.append(card.item);
      }
      cards.get(sensor.name).show(sensor);
    }
  };
  return watchSensors(page, show);
}

// What a screen reader is told when it changes: how many parts are how.
function counted(sensors, words) {
  const of = (verdict) => sensors.filter((sensor) => sensor.verdict === verdict).length;
  const [failed, warning, fine, absent] = ["failed", "warning", "fine", "skipped"].map(of);
  if (failed + warning === 0 && fine > 0) return words.say("sensor.all_fine", { n: fine });
  const parts = [];
  if (failed) parts.push(words.say("sensor.failed", { n: failed }));
  if (warning) parts.push(words.say("sensor.warning", { n: warning }));
  if (fine) parts.push(words.say("sensor.fine", { n: fine }));
  if (absent) parts.push(words.say("sensor.absent", { n: absent }));
  return parts.join(" · ");
}

function makeCard(name, words) {
  const verdict = element("span", { className: "verdict" });
  const age = element("span", { className: "age" });
  const text = element("p", { className: "text" });
  const cure = element("p", { className: "cure" });
  const values = element("dl", { className: "values" });
  const label = words.sayOr(`sensor.name.${name}`, name);
  const item = element(
    "li",
    { className: "sensor", data: { sensor: name } },
    element("h3", {}, element("span", { text: label }), verdict),
    text,
    cure,
    values,
    age,
  );
  const shown = new Map();
  const show = (sensor) => {
    item.dataset.level = LEVELS[sensor.verdict] ?? "";
    item.dataset.verdict = sensor.verdict;
    const word = words.sayOr(`sensor.verdict.${sensor.verdict}`, sensor.verdict);
    const sign = SIGNS[sensor.verdict] ?? "";
    setText(verdict, sign === word ? sign : `${sign} ${word}`);
    setText(text, words.sayOr(sensor.text_key, sensor.text));
    setText(cure, sensor.cure && words.sayOr(sensor.cure_key, sensor.cure));
    setText(age, sensor.age_s === null || sensor.age_s < 3 ? "" : words.say("sensor.age", { age: words.duration(sensor.age_s) }));
    for (const [key, value] of Object.entries(sensor.values)) {
      if (FORMATS[key] === undefined) continue;
      if (!shown.has(key)) {
        const number = element("dd");
        const row = pair(words.say(`sensor.value.${key}`), number);
        shown.set(key, { row, number });
        values.append(row);
      }
      setText(shown.get(key).number, FORMATS[key](value, words));
    }
    for (const [key, { row }] of shown) row.hidden = !(key in sensor.values);
  };
  return { item, show };
}
