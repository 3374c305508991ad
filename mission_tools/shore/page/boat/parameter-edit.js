// The field for a parameter's value: a choice, bits to tick, or a number. Each is {box, read(), show(value)}.
import { element, ticked } from "../shared/elements.js";

const MOST_CHOICES = 40; // above, a list is longer to search than a number is to write

export function makeField(parameter, id, words) {
  if (parameter.bits.length > 0) return bitField(parameter, words);
  return isChoice(parameter) ? choiceField(parameter, id, words) : numberField(parameter, id, words);
}

// Whether the listed values are all that are possible.
export function isChoice({ values, min, max, type }) {
  if (values.length === 0 || values.length > MOST_CHOICES || type === "Float") return false;
  return min === null || max === null || max - min + 1 <= values.length;
}

// A number as people write it: as exact as a 32-bit float is.
export const written = (value, words) =>
  value === null ? words.say("param.no_number") : value.toLocaleString(words.language, { maximumSignificantDigits: 8, useGrouping: false });

// A value in words: a choice by its name.
export function valueText(parameter, value, words) {
  const choice = parameter.bits.length === 0 && parameter.values.find((one) => one.value === value);
  if (choice) return words.say("param.choice", { value: written(value, words), text: choice.text });
  return parameter.unit ? words.say("param.value_unit", { value: written(value, words), unit: parameter.unit }) : written(value, words);
}

function choiceField(parameter, id, words) {
  const box = element("select", { id });
  const show = (value) => {
    const known = parameter.values.map((one) => new Option(valueText(parameter, one.value, words), one.value));
    const isListed = parameter.values.some((one) => one.value === value);
    if (!isListed && value !== null) known.push(new Option(written(value, words), value));
    box.replaceChildren(...known);
    box.value = String(value);
  };
  return { box, read: () => (box.value === "" ? null : Number(box.value)), show, label: true };
}

function bitField(parameter, words) {
  let before = 0; // bits without a text stay as they are
  const ticks = parameter.bits.map(({ bit, text }) => {
    return { bit, ...ticked(text || words.say("param.bit", { bit })) };
  });
  const box = element(
    "fieldset",
    { className: "param-bits" },
    element("legend", { text: words.say("param.value") }),
    ...ticks.map(({ label }) => label),
  );
  const isSigned = parameter.type.startsWith("Int");
  const read = () => {
    let value = before >>> 0;
    for (const { bit, tick } of ticks) value = tick.checked ? value | (1 << bit) : value & ~(1 << bit);
    return isSigned ? value | 0 : value >>> 0;
  };
  const show = (value) => {
    before = value ?? 0;
    for (const { bit, tick } of ticks) tick.checked = ((before >>> bit) & 1) === 1;
  };
  return { box, read, show, label: false };
}

function numberField(parameter, id, words) {
  const isWhole = parameter.type !== "Float";
  const step = parameter.step ?? (isWhole ? 1 : "any");
  const field = element("input", {
    id, type: "number", step, min: parameter.min, max: parameter.max, autocomplete: "off",
    inputmode: parameter.min !== null && parameter.min >= 0 ? (isWhole ? "numeric" : "decimal") : null,
  });
  const unit = parameter.unit ? element("span", { className: "unit", text: parameter.unit }) : null;
  const box = element("span", { className: "param-number" }, field, unit);
  const show = (value) => (field.value = value === null ? "" : String(value));
  const read = () => (field.value.trim() === "" || !Number.isFinite(field.valueAsNumber) ? null : field.valueAsNumber);
  return { box, read, show, label: true };
}
