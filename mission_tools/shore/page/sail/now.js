// Now: the mode, and a cell for each value. A level is told by a sign and a word, never by colour alone.
import { element, setText } from "../shared/elements.js";

const SERIAL = /^serial:(.*?)(?::\d+)?$/;
const NETWORK = /^(?:tcp|udp)(?:in|out)?:(.*):\d+$/;
const LOOPBACK = /^(?:127\.|localhost$|\[?::1\]?$)/;
const SIGNS = { good: "✓", warn: "▲", bad: "✕" };
const FIX_LEVEL = { none: "bad", "2D": "warn" };

const battery = (state, words) => {
  const battery = state.battery;
  if (!battery) return null;
  const details = [];
  if (battery.percent !== undefined) details.push(words.percent(battery.percent / 100));
  if (battery.voltage_v !== undefined) details.push(words.say("unit.v", { n: words.number(battery.voltage_v, 1) }));
  const { percent = 100, left_s = Infinity } = battery;
  const level = percent < 15 || left_s < 600 ? "bad" : percent < 30 || left_s < 1800 ? "warn" : "good";
  if (battery.left_s === undefined) return { value: details.shift() ?? "–", note: details.join(" · "), level };
  return { value: words.duration(battery.left_s), note: details.join(" · "), level };
};

const fix = (state, words) => {
  if (!state.fix) return null;
  const notes = [];
  if (state.fix.error_m !== undefined) notes.push(words.say("now.fix.error", { m: words.distance(state.fix.error_m) }));
  if (state.fix.satellites !== undefined) notes.push(words.say("now.fix.satellites", { n: state.fix.satellites }));
  const type = words.sayOr(`fix.${state.fix.type}`, state.fix.type);
  return { value: type, note: notes.join(" · "), level: FIX_LEVEL[state.fix.type] ?? "good" };
};

const speed = (state, words) => {
  if (state.speed_m_s === undefined) return null;
  const note = state.course_deg === undefined ? "" : words.say("now.course", { n: words.number(state.course_deg) });
  return { value: words.speed(state.speed_m_s), note };
};

const home = (state, words) => {
  if (state.home?.distance_m === undefined) return null;
  const time_s = state.home.time_s;
  const note = time_s === undefined ? "" : words.say("now.home.time", { time: words.duration(time_s) });
  return { value: words.distance(state.home.distance_m), note };
};

const compass = (state, words) => {
  if (!state.compass) return null;
  const heading = state.heading_deg;
  const { ok } = state.compass;
  const direction = heading === undefined ? "" : words.say("unit.degrees", { n: words.number(heading) });
  const verdict = words.say(ok ? "now.compass.good" : "now.compass.bad");
  return { value: direction || verdict, note: words.told(state.compass) || (direction ? verdict : ""), level: ok ? "good" : "bad" };
};

// Of the name that the boat's status has: a port's URL, or a name from the configuration.
function linkName({ name, heard }, words) {
  const serial = SERIAL.exec(name);
  const network = NETWORK.exec(name);
  const short = serial
    ? words.say(/ttyUSB|ttyACM|usb/.test(serial[1]) ? "link.usb" : "link.serial")
    : network
      ? words.say(LOOPBACK.test(network[1]) ? "link.computer" : "link.network")
      : name;
  const stations = [...new Set((heard ?? []).map((address) => address.split("/")[0]))];
  return stations.length === 0 ? short : words.say("link.station", { name: short, n: stations.join(", ") });
}

const links = (state, words) => {
  if (!state.links?.length) return null;
  const worst = Math.max(...state.links.map((link) => link.loss));
  const each = state.links.map((link) => words.say("now.link", { name: linkName(link, words), loss: words.percent(link.loss) }));
  return {
    value: words.say("now.links.loss", { loss: words.percent(worst) }),
    note: each.join(" · "),
    level: worst > 0.5 ? "bad" : worst > 0.15 ? "warn" : "good",
  };
};

const temperature = (state, words) => {
  const t = state.temperature_c;
  if (t === undefined) return null;
  return { value: words.say("unit.celsius", { n: words.number(t) }), level: t > 80 ? "bad" : t > 70 ? "warn" : "good" };
};

const disk = (state, words) => {
  const free = state.disk_free_mb;
  if (free === undefined) return null;
  const value =
    free < 1000
      ? words.say("unit.mb", { n: words.number(free) })
      : words.say("unit.gb", { n: words.number(free / 1000, 1) });
  return { value, level: free < 100 ? "bad" : free < 500 ? "warn" : "good" };
};

const current = (state, words) => {
  if (!state.current) return null;
  const note = words.say("now.current.towards", { n: words.number(state.current.towards_deg) });
  return { value: words.speed(state.current.speed_m_s), note };
};

const mission = (state, words) => {
  if (!state.mission) return null;
  if (state.mission.count === 0) return { value: words.say("now.mission.none") };
  const of = { current: state.progress?.current ?? 0, count: state.mission.count };
  const stage = state.progress?.state;
  return { value: words.say("now.mission.of", of), note: stage ? words.sayOr(`stage.${stage}`, stage) : "" };
};

// isMain: in the strip of the phone's one screen; the others there only when they are not well, or by More.
const CELLS = [
  { name: "battery", label: "now.battery", show: battery, isMain: true },
  { name: "fix", label: "now.fix", show: fix, isMain: true },
  { name: "speed", label: "now.speed", show: speed, isMain: true },
  { name: "home", label: "now.home", show: home, isMain: true },
  { name: "compass", label: "now.compass", show: compass },
  { name: "links", label: "now.links", show: links },
  { name: "mission", label: "now.mission", show: mission },
  { name: "current", label: "now.current", show: current },
  { name: "temperature", label: "now.temperature", show: temperature },
  { name: "disk", label: "now.disk", show: disk },
];

export function makeNow(page, words) {
  const shown = new Map(CELLS.map((cell) => [cell.name, makeCell(page.cells, cell, words)]));
  page.more.addEventListener("click", () => {
    const isOpen = page.cells.classList.toggle("all");
    page.more.setAttribute("aria-expanded", String(isOpen));
  });
  return (state) => {
    const mode = state.mode;
    setText(page.mode, mode === undefined ? words.say("now.mode.none") : words.sayOr(`mode.${mode}`, mode));
    const isCritical = state.state === "critical" || state.state === "emergency";
    setText(page.alarm, isCritical ? `${SIGNS.warn} ${words.sayOr(`state.${state.state}`, state.state)}` : "");
    const armed = state.armed === undefined ? "now.armed.none" : state.armed ? "now.armed.yes" : "now.armed.no";
    setText(page.armed, words.say(armed));
    page.armed.classList.toggle("is-armed", state.armed === true);
    for (const cell of CELLS) shown.get(cell.name)(cell.show(state, words));
  };
}

function makeCell(list, { name, label, isMain }, words) {
  const term = element("dt", { text: words.say(label) });
  const [value, note] = ["value", "note"].map((className) => element("dd", { className }));
  const item = element("div", { id: `now-${name}`, className: isMain ? "cell main" : "cell" }, term, value, note);
  list.append(item);
  return (what) => {
    const level = what?.level ?? "";
    setText(value, what?.value ?? "–");
    setText(note, what?.note ?? "");
    item.dataset.level = level;
    setText(term, level ? `${words.say(label)} ${SIGNS[level]}` : words.say(label));
  };
}
