// Parameters kept in a file, and a file compared with the boat: what differs is ticked, and set one after another.
import { written } from "./parameter-edit.js";
import { setParameter } from "./parameter-row.js";
import { button, element, setAnswer, ticked } from "../shared/elements.js";

export function makeFiles(page) {
  const { words } = page;
  const keep = element("a", { className: "button", text: words.say("param.file.keep") });
  const chosen = element("input", { type: "file", id: "param-file", accept: ".param,.parm,.params,.txt" });
  const status = element("p", { className: "param-answer", role: "status" });
  const found = element("div", { className: "param-found" });
  const pin = element("p", { className: "param-note", text: words.say("param.file.pin") });
  const tools = element(
    "div",
    { className: "param-tools" },
    keep,
    element("label", { className: "param-choose", for: "param-file", text: words.say("param.file.compare") }),
    chosen,
  );
  const inside = element("div", { className: "param-inside" }, pin, tools, status, found);
  const box = element("details", { className: "param-files" }, element("summary", { text: words.say("param.file.title") }), inside);

  const told = (text, isGood = null) => setAnswer(status, text, isGood);

  chosen.addEventListener("change", async () => {
    const [file] = chosen.files;
    if (file === undefined) return;
    found.replaceChildren();
    told(words.say("param.file.asked", { name: file.name }));
    try {
      const answer = await fetch(`/api/boats/${page.live.boat}/parameters/compare`, { method: "POST", body: file });
      const content = await answer.json();
      if (answer.ok) show(content);
      else told(words.refusal(content), false);
    } catch {
      told(words.say("param.lost"), false);
    }
    chosen.value = ""; // so that the same file can be chosen again
  });

  const show = ({ differences, same, unknown }) => {
    const n = differences.length;
    told([
      words.say(n === 0 ? "param.file.same" : "param.file.differ", { n, same }),
      ...(unknown.length > 0 ? [words.say("param.file.unknown", { n: unknown.length, names: named(unknown) })] : []),
    ].join(" "));
    if (n > 0) found.replaceChildren(makeDifferences(differences, page, told));
  };

  return {
    box,
    showLink() {
      const isSkipper = page.live.isSkipper;
      pin.hidden = isSkipper;
      tools.hidden = !isSkipper;
      keep.href = `/api/boats/${page.live.boat}/parameters.param`;
      keep.download = `boat-${page.live.boat}.param`;
    },
  };
}

const named = (names) => (names.length > 5 ? `${names.slice(0, 5).join(", ")} …` : names.join(", "));

function makeDifferences(differences, page, told) {
  const { words } = page;
  const rows = differences.map((one) => makeDifference(one, words));
  const { tick: all, label: everything } = ticked(words.say("param.file.all"), "tick", true);
  all.addEventListener("change", () => {
    for (const { tick } of rows) if (!tick.disabled) tick.checked = all.checked;
  });
  const apply = button(words.say("param.file.set"), async () => {
    apply.disabled = true;
    const chosen = rows.filter(({ tick }) => tick.checked && !tick.disabled);
    let done = 0;
    for (const row of chosen) {
      told(words.say("param.file.setting", { done, n: chosen.length, name: row.one.name }));
      row.told(words.say("param.asked"));
      const result = await setParameter(page, row.one.name, row.one.file);
      row.told(result.text, result.ok === true);
      if (result.ok) {
        done += 1;
        row.tick.checked = false;
        row.tick.disabled = true;
      }
    }
    told(words.say("param.file.done", { done, n: chosen.length }), done === chosen.length ? null : false);
    apply.disabled = false;
  }, { className: "strong" });
  const list = element("ul", { className: "param-differences" }, ...rows.map(({ item }) => item));
  return element("div", {}, everything, list, apply);
}

function makeDifference(one, words) {
  const tick = element("input", { type: "checkbox" });
  tick.checked = !one.read_only;
  tick.disabled = one.read_only;
  const change = words.say(one.unit ? "param.file.change_unit" : "param.file.change", {
    now: written(one.now, words), file: written(one.file, words), unit: one.unit,
  });
  const answer = element("span", { className: "param-answer", role: "status" });
  if (one.read_only) answer.textContent = words.say("param.read_only");
  const what = element("span", { className: "param-what" }, element("b", { text: one.name }), element("span", { text: one.text }), element("span", { text: change }));
  const item = element("li", {}, element("label", { className: "tick" }, tick, what), answer);
  return { item, tick, one, told: (text, isGood = null) => setAnswer(answer, text, isGood) };
}
