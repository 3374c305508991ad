// Logs: what the boat keeps of its voyages, to download, to look at, or to chart depths by.
import { button, element, setText } from "../shared/elements.js";
import { makeDepths } from "./depths.js";
import { makeVoyage } from "./voyage.js";
import { size } from "./words.js";

const LOOK_MS = 5_000;
const SOON_MS = 1_000; // while the list or a log is fetched
const ASK_MS = 400; // how far a voyage is
const STEPS = { fetching: "logs.fetching", reading: "logs.reading", charting: "depths.charting" };
const NOTHING = { type: "FeatureCollection", features: [] };

export function makeView(box, page) {
  const { words, live } = page;
  const status = element("p", { className: "status", role: "status", text: words.say("logs.asked") });
  const locked = element("p", { className: "locked", text: words.say("logs.pin"), hidden: true });
  const list = element("ul", { className: "list" });
  const progress = element("progress", { max: 1, value: 0, "aria-label": words.say("logs.progress") });
  const step = element("span", {});
  const cancel = button(words.say("logs.cancel"), () => stop());
  const fetching = element("div", { className: "fetching", role: "group", "aria-label": words.say("logs.progress"), hidden: true }, step, progress, cancel);
  const overview = element("div", { className: "overview" }, element("h2", { text: words.say("logs.title") }), status, locked, fetching, list);
  box.append(overview);
  let isOpen = false;
  let timer = 0;
  let boat = null;
  let rows = new Map(); // by name
  let wanted = null; // {name, kind} that is waited for
  let shown = null; // a voyage or a chart
  let geojson = null;

  const stop = () => {
    wanted = null;
    fetching.hidden = true;
    show();
  };
  const close = () => {
    shown.remove();
    overview.hidden = false;
    const { name, kind } = shown.dataset;
    shown = null;
    rows.get(name)?.[kind].focus();
  };

  async function look() {
    clearTimeout(timer);
    if (!isOpen) return;
    if (live.boat !== boat) {
      boat = live.boat;
      rows = new Map();
      list.replaceChildren();
      if (wanted !== null) stop();
      if (shown !== null) close();
    }
    let next_ms = LOOK_MS;
    if (boat !== null) {
      const asked = boat;
      const [code, logs] = await fetched(`/api/boats/${boat}/logs`);
      if (asked !== boat) return void look();
      if (code === 200) next_ms = showLogs(logs) ? SOON_MS : LOOK_MS;
      else {
        setText(status, code === 0 ? words.say("logs.lost") : words.refusal(logs));
        next_ms = SOON_MS;
      }
    }
    clearTimeout(timer);
    if (isOpen) timer = setTimeout(look, next_ms);
  }

  // Returns whether a log is being downloaded.
  function showLogs(logs) {
    setText(status, words.say(logs.length === 0 ? "logs.none" : logs.length === 1 ? "logs.one" : "logs.many", { n: logs.length }));
    const names = logs.map(({ name }) => name);
    for (const [name, { line }] of rows)
      if (!names.includes(name)) {
        line.remove();
        rows.delete(name);
      }
    logs.forEach((log, n) => {
      const row = rows.get(log.name) ?? makeRow(log.name);
      rows.set(log.name, row);
      if (list.children[n] !== row.line) list.insertBefore(row.line, list.children[n] ?? null);
      setText(row.date, log.at_s === null ? words.say("logs.no_date") : words.date(log.at_s));
      setText(row.size, size(log.bytes, words));
      row.download.title = log.name;
      row.sent.hidden = log.fetched_bytes === null;
      if (log.fetched_bytes !== null) {
        row.sent.value = log.fetched_bytes / Math.max(log.bytes, 1);
        row.sent.setAttribute("aria-label", words.say("logs.sent", { name: log.name }));
      }
    });
    show();
    return logs.some((log) => log.fetched_bytes !== null);
  }

  function makeRow(name) {
    const download = element("a", { className: "button", download: "", text: words.say("logs.download"), "aria-label": words.say("logs.download_of", { name }) });
    const voyage = button(words.say("logs.show"), () => open(name, "voyage"), { "aria-label": words.say("logs.show_of", { name }) });
    const chart = button(words.say("depths.chart"), () => open(name, "chart"), { "aria-label": words.say("depths.chart_of", { name }) });
    const [date, bytes, long] = ["date", "size", "long"].map((className) => element("span", { className }));
    const sent = element("progress", { max: 1, value: 0, hidden: true });
    const what = element("div", { className: "what" }, element("b", { text: name }), date, bytes, long);
    return { line: element("li", {}, what, sent, download, voyage, chart), download, voyage, chart, date, size: bytes, long, sent };
  }

  // Links and buttons as the PIN allows.
  function show() {
    locked.hidden = live.isSkipper || rows.size === 0;
    for (const [name, { download, voyage, chart }] of rows) {
      voyage.disabled = chart.disabled = !live.isSkipper || wanted !== null;
      if (live.isSkipper) {
        download.href = `/api/boats/${boat}/logs/${name}`;
        download.removeAttribute("role");
        download.removeAttribute("aria-disabled");
      } else {
        download.removeAttribute("href");
        download.setAttribute("role", "link");
        download.setAttribute("aria-disabled", "true");
      }
    }
  }

  async function open(name, kind) {
    const job = { name, kind };
    wanted = job;
    const address = `/api/boats/${boat}/logs/${name}/${kind}`;
    const isChart = kind === "chart";
    progress.value = 0;
    fetching.hidden = false;
    setText(step, words.say("logs.fetching", { name }));
    show();
    cancel.focus();
    if (!isChart) geojson = geojson ?? (await fetched("/api/chart"))[1];
    while (wanted === job) {
      const [code, answer] = await fetched(address, isChart ? "POST" : "GET");
      if (wanted !== job) break;
      if (code === 202) {
        if (answer.step === "fetching") progress.value = answer.share;
        else progress.removeAttribute("value"); // nobody knows how long it takes
        setText(step, words.say(STEPS[answer.step], { name }));
        await new Promise((resolve) => setTimeout(resolve, ASK_MS));
      } else if (code === 200) {
        return present(job, isChart ? makeDepths(name, answer, address, words, close) : voyageOf(name, answer));
      } else {
        stop();
        page.go.tell(code === 0 ? words.say("logs.lost") : words.refusal(answer), false);
        return void rows.get(name)?.[kind].focus();
      }
    }
    if (isChart && (wanted?.kind !== kind || wanted.name !== name)) await fetched(address, "DELETE");
  }

  function voyageOf(name, found) {
    const row = rows.get(name);
    if (row) setText(row.long, words.say("logs.long", { time: words.duration(found.duration_s), distance: words.distance(found.distance_m) }));
    return makeVoyage(name, found, geojson?.features ? geojson : NOTHING, words, close);
  }

  function present(job, article) {
    stop();
    shown = article;
    Object.assign(shown.dataset, job);
    overview.hidden = true;
    box.append(shown);
    box.scrollTop = 0;
    shown.querySelector("h2").focus();
  }

  return {
    opened() {
      isOpen = true;
      look();
    },
    closed() {
      isOpen = false;
      clearTimeout(timer);
    },
    showState() {
      show();
      if (live.boat !== boat) look();
    },
  };
}

// Status and JSON; 0 where there was no answer.
async function fetched(address, method = "GET") {
  try {
    const answer = await fetch(address, { method });
    return [answer.status, await answer.json()];
  } catch {
    return [0, null];
  }
}
