// Route or survey, and the planner's options.
import { element, ticked } from "../shared/elements.js";
import { FIELDS, SWITCHES } from "./draft.js";

const TASKS = [["route", "plan.route"], ["survey", "plan.survey"]];

// Two buttons of which one is chosen.
export function makeTasks(draft, page, changed) {
  const { words } = page;
  const radios = TASKS.map(([task]) => {
    const radio = element("input", { type: "radio", name: "plan-task", value: task });
    radio.addEventListener("change", () => {
      draft.task = task;
      changed();
    });
    return radio;
  });
  const labels = radios.map((radio, n) => element("label", {}, radio, element("span", { text: words.say(TASKS[n][1]) })));
  const made = element("fieldset", { className: "tasks" }, element("legend", { className: "unseen", text: words.say("plan.task") }), ...labels);
  const show = () => radios.forEach((radio) => (radio.checked = radio.value === draft.task));
  return { made, show };
}

export function makeOptions(box, draft, page, changed) {
  const { words } = page;
  const rows = [];
  for (const { name, label, tasks } of SWITCHES) {
    const { tick, label: made } = ticked(words.say(label), "switch", draft.options[name] === true);
    tick.addEventListener("change", () => {
      draft.options[name] = tick.checked;
      changed();
    });
    rows.push({ made, tasks, name, input: tick });
  }
  for (const { name, label, tasks } of FIELDS) {
    const input = element("input", { inputmode: "decimal", maxlength: 8, autocomplete: "off" });
    input.value = draft.options[name] ?? "";
    input.addEventListener("input", () => {
      draft.options[name] = input.value.replace(",", ".");
      input.removeAttribute("aria-invalid");
      changed();
    });
    const made = element("label", { className: "number" }, element("span", { text: words.say(label) }), input);
    rows.push({ made, tasks, name, input });
  }
  box.append(...rows.map(({ made }) => made), element("p", { className: "hint", text: words.say("plan.empty") }));
  return {
    show: () => rows.forEach(({ made, tasks }) => (made.hidden = !tasks.includes(draft.task))),
    point(name) {
      const { input } = rows.find((row) => row.name === name);
      input.setAttribute("aria-invalid", "true");
      input.closest("details").open = true;
      input.focus();
    },
  };
}
