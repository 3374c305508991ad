// Parameters: searched as you type, in groups, each with its texts and a field. A row is built when it is looked at.
import { makeFiles } from "./parameter-file.js";
import { watchParameters } from "./parameter-feed.js";
import { makeRow } from "./parameter-row.js";
import { button, element, setText, ticked } from "../shared/elements.js";

export const title = "param.title";

const AT_ONCE = 50; // rows; more on demand
const TYPING_MS = 120;

export function makePanel(inside, page) {
  const { words } = page;
  const status = element("p", { className: "param-status", role: "status", text: words.say("param.waiting") });
  const progress = element("progress", { "aria-label": words.say("param.title"), hidden: true });
  const note = element("p", { className: "param-note", hidden: true });
  const access = element("p", { className: "param-note", hidden: true });
  const search = element("input", { type: "search", id: "param-search", autocomplete: "off", placeholder: words.say("param.search_hint") });
  const { tick: changed, label: onlyChanged } = ticked(words.say("param.only_changed"));
  const tools = element(
    "div",
    { className: "param-tools", hidden: true },
    element("label", { className: "param-search", for: "param-search" }, element("span", { text: words.say("param.search") }), search),
    onlyChanged,
  );
  const results = element("div", { className: "param-list" });
  const files = makeFiles(page);
  files.box.hidden = true;
  inside.append(access, note, files.box, tools, status, progress, results);

  let boat = null;
  let parameters = []; // by name
  let texts = "";
  let counted = ""; // the status while there is a list
  const rows = new Map();

  const row = (parameter) => {
    if (!rows.has(parameter.name)) rows.set(parameter.name, makeRow(parameter, page));
    return rows.get(parameter.name).box;
  };

  const tell = (key, values) => {
    counted = words.say(key, values);
    setText(status, counted);
  };

  const draw = () => {
    const wanted = search.value.toLowerCase().split(/\s+/).filter(Boolean);
    if (wanted.length === 0 && !changed.checked) {
      tell("param.count", { n: parameters.length });
      results.replaceChildren(...groupsOf(parameters, row, words));
      return;
    }
    const found = parameters.filter((one) => (!changed.checked || one.changed) && wanted.every((word) => one.haystack.includes(word)));
    found.sort((a, b) => rank(a, wanted[0]) - rank(b, wanted[0])); // stable: by name within a rank
    tell(found.length === 0 ? "param.none" : "param.found", { n: found.length, all: parameters.length });
    results.replaceChildren();
    fill(results, found, row, words);
  };

  const showList = (list) => {
    const names = parameters.map((one) => one.name).join();
    parameters = list.parameters.map((one) => ({ ...one, haystack: [one.name, one.text, one.long, one.group].join("\n").toLowerCase() }));
    const isNew = list.texts !== texts || parameters.map((one) => one.name).join() !== names;
    texts = list.texts;
    if (isNew) rows.clear(); // the texts have come
    for (const one of parameters) rows.get(one.name)?.show(one);
    const notes = [];
    if (list.missing > 0) notes.push(words.say("param.missing", { n: list.missing }));
    if (list.texts === "loading") notes.push(words.say("param.texts_loading"));
    if (list.texts === "none") notes.push(words.say("param.texts_none"));
    setText(note, notes.join(" "));
    note.hidden = notes.length === 0;
    tools.hidden = files.box.hidden = false;
    if (isNew) draw();
    else setText(status, counted);
  };

  const show = (news) => {
    if (news.boat !== boat) {
      boat = news.boat;
      parameters = [];
      rows.clear();
      results.replaceChildren();
    }
    results.classList.toggle("old", news.list === undefined);
    progress.hidden = news.progress === undefined || news.progress.count === null;
    if (news.list) {
      showList(news.list);
    } else if (news.progress) {
      const { got, count } = news.progress;
      if (count !== null) Object.assign(progress, { max: count, value: got });
      setText(status, words.say(count === null ? "param.waiting" : "param.loading", { got, count }));
    } else if (news.isLost || page.live.isSkipper) setText(status, news.refusal ?? words.say("param.lost"));
    else setText(status, "");
  };

  let timer = null;
  search.addEventListener("input", () => {
    clearTimeout(timer);
    timer = setTimeout(draw, TYPING_MS);
  });
  changed.addEventListener("change", draw);
  const showState = ({ armed }) => {
    const key = !page.live.isSkipper ? "param.viewer" : armed !== false ? "param.armed" : "";
    access.hidden = key === "";
    if (key !== "") setText(access, words.say(key));
    files.showLink();
  };
  return { ...watchParameters(page, show), showState };
}

// Names that begin with the word, names with it in them, then texts.
function rank({ name }, word = "") {
  const at = name.toLowerCase().indexOf(word);
  return at === 0 ? 0 : at > 0 ? 1 : 2;
}

// Folded groups, whose rows are built when they are opened.
function groupsOf(parameters, row, words) {
  const groups = new Map();
  for (const one of parameters) groups.set(one.group, [...(groups.get(one.group) ?? []), one]);
  return [...groups].sort(([a], [b]) => a.localeCompare(b)).map(([name, members]) => {
    const count = words.say("param.group", { n: members.length });
    const summary = element("summary", {}, element("h3", { text: name }), element("span", { className: "param-count", text: count }));
    const box = element("details", { className: "param-group" }, summary);
    const list = element("div", { className: "param-list" });
    box.addEventListener("toggle", () => {
      if (!box.open || list.isConnected) return;
      box.append(list);
      fill(list, members, row, words);
    });
    return box;
  });
}

// The first rows, and a button for the next ones.
function fill(list, members, row, words) {
  list.append(...members.slice(0, AT_ONCE).map(row));
  const left = members.slice(AT_ONCE);
  if (left.length === 0) return;
  const more = button(words.say("param.more", { n: left.length }), () => {
    const first = row(left[0]);
    fill(list, left, row, words);
    more.remove();
    first.querySelector("summary").focus();
  });
  list.append(more);
}
