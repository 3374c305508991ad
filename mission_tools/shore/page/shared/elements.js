// Building the page's elements. Text is set as text, never as markup.

// options: {className, text, data: {name: value}, on: {event: listener}}, and any attribute by its name; true is a
// bare attribute, false, null and undefined leave it out.
export function element(tag, options = {}, ...children) {
  const { className, text, data, on, ...attributes } = options;
  const made = document.createElement(tag);
  if (className) made.className = className;
  if (text !== undefined) made.textContent = text;
  for (const [name, value] of Object.entries(data ?? {})) made.dataset[name] = value;
  for (const [event, listener] of Object.entries(on ?? {})) made.addEventListener(event, listener);
  for (const [name, value] of Object.entries(attributes))
    if (value !== false && value !== null && value !== undefined) made.setAttribute(name, value === true ? "" : value);
  made.append(...children.filter((child) => child !== null && child !== undefined));
  return made;
}

// A screen reader and the layout notice only what changed.
export function setText(element, text) {
  if (element.textContent !== text) element.textContent = text;
}

// An answer with its sign and level: good, bad, or neither yet.
export function setAnswer(element, text, isGood = null) {
  setText(element, `${isGood === null ? "" : isGood ? "✓ " : "✕ "}${text}`);
  element.dataset.level = isGood === null ? "" : isGood ? "good" : "bad";
}

// A box to tick with its text.
export function ticked(text, className = "tick", isChecked = false) {
  const tick = element("input", { type: "checkbox" });
  tick.checked = isChecked;
  return { tick, label: element("label", { className }, tick, element("span", { text })) };
}

// A term and its value, a text or an element, for a <dl>.
export const pair = (term, value) =>
  element("div", {}, element("dt", { text: term }), typeof value === "string" ? element("dd", { text: value }) : value);

// A button that acts at once.
export const button = (text, act, options = {}) => element("button", { type: "button", text, on: { click: act }, ...options });

const SVG = "http://www.w3.org/2000/svg";

function drawn(tag, attributes, ...children) {
  const made = document.createElementNS(SVG, tag);
  for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, value);
  made.append(...children);
  return made;
}

// A button for holdButton of hold.js: a ring that fills round a symbol (its id in index.html), and a text.
export function heldButton(symbol, text, options = {}) {
  const circle = { cx: 22, cy: 22, r: 19 };
  const ring = drawn(
    "svg",
    { class: "ring", viewBox: "0 0 44 44", "aria-hidden": "true" },
    drawn("circle", circle),
    drawn("circle", { ...circle, class: "share", pathLength: 100 }),
    drawn("use", { href: `#${symbol}`, x: 11, y: 11, width: 22, height: 22 }),
  );
  const { className = "", ...others } = options;
  return element("button", { type: "button", className: `held ${className}`.trim(), ...others }, ring, element("span", { text }));
}
