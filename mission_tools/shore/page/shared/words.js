// All texts of the page, from words.LANGUAGE.json, and numbers as people read them.

// The first of the browser's languages that the server has; else English.
export function languageOf(wanted, known) {
  for (const language of wanted)
    for (const one of [language, language.split("-")[0]]) if (known.includes(one)) return one;
  return "en";
}

export class Words {
  constructor(texts) {
    this.texts = texts;
    this.language = texts["language"] ?? "en";
  }

  // The text of a key, with {names} replaced. A value is a text, a number, or what the server says.
  say = (key, values = {}) => (this.texts[key] ?? key).replace(/\{(\w+)\}/g, (whole, name) => this.#value(values[name] ?? whole));

  #value = (value) => {
    if (typeof value === "number") return value.toLocaleString(this.language, { maximumFractionDigits: 2 });
    return typeof value === "object" ? this.told(value) : String(value);
  };

  // What the server says, in this page's language: {text, key, values}; the text where it is not one of ours.
  told = ({ text, key, values }) => (key && key in this.texts ? this.say(key, values) : (text ?? ""));

  // An error of the server's HTTP interface.
  refusal = ({ error, key, values, expected, expects }) => {
    const said = this.told({ text: error, key, values });
    const wanted = this.told({ text: expected, ...expects });
    return said && wanted ? this.say("error.with", { error: said, expected: wanted }) : said || wanted;
  };

  // The text of a key that depends on data, or `otherwise` where there is none.
  sayOr = (key, otherwise) => this.texts[key] ?? otherwise;

  number = (value, digits = 0) =>
    value.toLocaleString(this.language, { minimumFractionDigits: digits, maximumFractionDigits: digits });

  distance = (metres) =>
    metres < 999.5
      ? this.say("unit.m", { n: this.number(metres, metres < 9.95 ? 1 : 0) })
      : this.say("unit.km", { n: this.number(metres / 1000, metres < 9950 ? 2 : 1) });

  speed = (metresPerSecond) => this.say("unit.m_s", { n: this.number(metresPerSecond, 1) });

  percent = (share) => this.say("unit.percent", { n: this.number(share * 100) });

  // Date and time of this browser's place, of seconds since 1970.
  date = (seconds) =>
    new Date(seconds * 1000).toLocaleString(this.language, { dateStyle: "medium", timeStyle: "short" });

  // Two units at most: 45 s, 12 min, 2 h 5 min, 3 d 4 h.
  duration = (seconds) => {
    const s = Math.max(0, seconds);
    if (s < 59.5) return this.say("unit.s", { n: this.number(s) });
    const minutes = Math.round(s / 60);
    if (minutes < 60) return this.say("unit.min", { n: this.number(minutes) });
    const hours = Math.floor(minutes / 60);
    if (hours < 24) return this.say("unit.h_min", { h: this.number(hours), min: this.number(minutes % 60) });
    return this.say("unit.d_h", { d: this.number(Math.floor(hours / 24)), h: this.number(hours % 24) });
  };

  // Said before a mission is uploaded: it replaces the one on board.
  replaces = (snapshot) => {
    const count = snapshot?.mission?.count;
    if (count === undefined || count === 0) return "";
    return this.say(count === 1 ? "mission.replaces_one" : "mission.replaces", { count: this.number(count) });
  };

  // Texts of the page's own elements: data-word is the text, data-word-label the name for screen readers.
  fill(root) {
    for (const element of root.querySelectorAll("[data-word]")) element.textContent = this.say(element.dataset.word);
    for (const element of root.querySelectorAll("[data-word-label]"))
      element.setAttribute("aria-label", this.say(element.dataset.wordLabel));
  }
}
