// A voyage: its figures, the track over the chart, graphs below it, and what happened. A moment chosen in one is shown in all.
import { isNight } from "../shared/chart-colours.js";
import { button, element, pair, setText } from "../shared/elements.js";
import { whenLight } from "./canvas.js";
import { makeGraph, nearest } from "./graph.js";
import { savePicture } from "./picture.js";
import { inkOf, speedSteps } from "./speed.js";
import { makeTrack } from "./track.js";
import { clock, eventText, figures, momentText, summary } from "./words.js";

const LEAST_M_S = 0.5;
const LEAST_V = 1;

function graphsOf(voyage, words) {
  const has = (values) => values.some((one) => one !== null);
  const speed = { name: words.say("logs.speed"), values: voyage.speeds_m_s };
  const wanted = { name: words.say("logs.wanted"), values: voyage.wanted_m_s, isDashed: true };
  return [
    { title: words.say(has(wanted.values) ? "logs.speeds_graph" : "logs.speed_graph"), series: has(wanted.values) ? [speed, wanted] : [speed], least: LEAST_M_S, fromZero: true },
    { title: words.say("logs.volts_graph"), series: [{ name: "", values: voyage.voltages_v }], least: LEAST_V },
    { title: words.say("logs.percent_graph"), series: [{ name: "", values: voyage.percents }], least: 10, most: 100 },
  ].filter(({ series }) => has(series[0].values));
}

function legendOf(voyage, words) {
  const lines = voyage.steps.map(({ from, to, width }) => {
    const line = element("span", { className: "line", "aria-hidden": "true" });
    line.style.borderTopWidth = `${width}px`;
    const text = element("span", { text: words.say("logs.from_to", { from: words.number(from, 1), to: words.number(to, 1) }) });
    return element("li", {}, line, text);
  });
  const legend = element("ul", { className: "legend", "aria-label": words.say("logs.legend") }, ...lines);
  const paint = () => lines.forEach((one, n) => (one.firstChild.style.borderTopColor = inkOf(n, isNight())));
  paint();
  whenLight(legend, paint);
  return legend;
}

// name: of the log; geojson: the water. back(): to the list.
export function makeVoyage(name, voyage, geojson, words, back) {
  voyage.steps = speedSteps(voyage.speeds_m_s);
  for (const event of voyage.events) event.place = nearest(voyage.times_s, event.at_s);
  const title = words.say("logs.voyage_of", { name, date: voyage.begun_s === null ? "" : words.date(voyage.begun_s) }).trim();
  const moment = element("p", { className: "moment", text: words.say("logs.hint") });
  const shown = [];
  const rows = [];
  const choose = (index) => {
    for (const one of shown) one.show(index);
    setText(moment, momentText(voyage, index, words));
    for (const { row, event } of rows) row.toggleAttribute("data-near", event.place === index);
  };
  const marks = voyage.events.filter(({ kind }) => kind !== "message").map(({ at_s }) => at_s);
  const graphs = graphsOf(voyage, words);
  const track = makeTrack(voyage, geojson, words, choose);
  shown.push(track, ...graphs.map((graph) => makeGraph(graph, voyage, marks, choose, (index) => momentText(voyage, index, words))));

  const list = (events) =>
    element("ol", {}, ...events.map((event) => {
      const row = button("", () => choose(event.place), { data: { kind: event.kind } });
      row.append(element("span", { className: "at", text: clock(event.at_s) }), " ", element("span", { text: eventText(event, words) }));
      rows.push({ row, event });
      return element("li", {}, row);
    }));
  const [main, messages] = [true, false].map((isMain) => voyage.events.filter(({ kind }) => (kind !== "message") === isMain));
  const told = element("details", { className: "events" }, element("summary", { text: words.say("logs.messages", { n: messages.length }) }), list(messages));
  const notes = [voyage.is_cut && "logs.cut", voyage.events_left_out > 0 && "logs.left_out"].filter(Boolean);

  const box = element(
    "article",
    { className: "voyage", "aria-label": title },
    element("div", { className: "head" },
      button(words.say("logs.back"), back),
      button(words.say("logs.save"), () => savePicture(name.replace(/\.bin$/i, ""), title, voyage, track.track, graphs, marks, words)),
    ),
    element("h2", { text: title, tabindex: -1 }),
    element("dl", {}, ...figures(voyage, words).map(([key, value]) => pair(words.say(key), value))),
    element("p", { className: "unseen", text: summary(voyage, words) }),
    ...notes.map((key) => element("p", { className: "note", text: words.say(key, { n: voyage.events_left_out }) })),
    element("div", { className: "pictures" },
      element("div", { className: "where" }, legendOf(voyage, words), track.box),
      element("div", { className: "when" }, moment, ...shown.slice(1).map((one) => one.box)),
    ),
    element("section", { className: "events", "aria-label": words.say("logs.events") }, element("h3", { text: words.say("logs.events") }), main.length > 0 ? list(main) : element("p", { text: words.say("logs.no_events") })),
    messages.length > 0 ? told : null,
  );
  return box;
}
