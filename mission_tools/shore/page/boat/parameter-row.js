// A parameter: a line with its value, which opens to its texts, a field and Save with the boat's answer.
import { makeField, valueText, written } from "./parameter-edit.js";
import { button, element, pair, setAnswer, setText } from "../shared/elements.js";

let made = 0;

export function makeRow(parameter, page) {
  const { words } = page;
  const value = element("span", { className: "param-value" });
  const mark = element("span", { className: "param-mark" });
  const summary = element(
    "summary",
    {},
    element("span", { className: "param-what" }, element("b", { text: parameter.name }), element("span", { text: parameter.text })),
    element("span", { className: "param-now" }, value, mark),
  );
  const box = element("details", { className: "param", data: { name: parameter.name } }, summary);
  let shown = parameter;
  let inside = null;

  const show = (next) => {
    shown = next;
    setText(value, valueText(next, next.value, words));
    setText(mark, next.changed ? words.say("param.changed") : "");
    inside?.show(next);
  };
  box.addEventListener("toggle", () => {
    if (!box.open || inside !== null) return;
    inside = makeInside(shown, page);
    box.append(inside.box);
  });
  show(parameter);
  return { box, show };
}

function makeInside(parameter, page) {
  const { words } = page;
  made += 1;
  const id = `param-${made}`;
  const field = parameter.read_only ? null : makeField(parameter, id, words);
  const answer = element("p", { className: "param-answer", role: "status" });
  const save = element("button", { className: "strong", text: words.say("param.save") });
  const back = button("", () => set(shown.default), { className: "param-back" });
  const facts = element("dl", { className: "param-facts" });
  let shown = parameter;
  let isTouched = false;

  const set = async (value) => {
    if (value === null) return setAnswer(answer, words.say("param.not_a_number"), false);
    save.disabled = back.disabled = true;
    setAnswer(answer, words.say("param.asked"));
    const result = await setParameter(page, shown.name, value);
    save.disabled = back.disabled = false;
    setAnswer(answer, result.text, result.ok === true);
    if (result.ok) isTouched = false;
    if (result.ok) field.show(result.value);
    return undefined;
  };

  const show = (next) => {
    shown = next;
    facts.replaceChildren(...factsOf(next, words));
    back.hidden = next.default === null || !next.changed || next.read_only;
    setText(back, words.say("param.back", { value: valueText(next, next.default, words) }));
    if (!isTouched && field !== null) field.show(next.value);
  };

  const form = element("form", { novalidate: true, on: { submit: (event) => { event.preventDefault(); set(field.read()); } } });
  if (field !== null) {
    form.addEventListener("input", () => (isTouched = true));
    const label = field.label ? element("label", { for: id, text: words.say("param.value") }) : null;
    form.append(...[label, field.box].filter(Boolean), element("span", { className: "param-buttons" }, save, back));
  }
  const notes = [
    parameter.long && parameter.long !== parameter.text ? element("p", { className: "param-long", text: parameter.long }) : null,
    parameter.read_only ? element("p", { className: "param-note", text: words.say("param.read_only") }) : null,
    parameter.reboot_required ? element("p", { className: "param-note", text: words.say("param.reboot") }) : null,
  ].filter(Boolean);
  const box = element("div", { className: "param-inside" }, ...notes, facts, form, answer);
  show(parameter);
  return { box, show };
}

function factsOf(parameter, words) {
  const { min, max, unit } = parameter;
  const facts = [["param.now", valueText(parameter, parameter.value, words)]];
  if (parameter.default !== null) facts.push(["param.default", valueText(parameter, parameter.default, words)]);
  if (min !== null || max !== null) {
    const [least, most] = [min, max].map((bound) => (bound === null ? "…" : written(bound, words)));
    facts.push(["param.range", words.say(unit ? "param.range_unit" : "param.range_of", { least, most, unit })]);
  }
  return facts.map(([key, text]) => pair(words.say(key), text));
}

// Asks the boat; {ok, text, value}: what it then has.
export async function setParameter(page, name, value) {
  const answer = await page.live.ask("set_parameter", { name, value });
  const otherwise = answer.lost ? "go.lost" : answer.ok === null ? "param.unknown" : answer.ok ? "go.done" : "go.refused";
  return { ok: answer.ok, text: answer.text || page.words.say(otherwise), value: answer.result?.value ?? value };
}
