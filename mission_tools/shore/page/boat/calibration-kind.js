// One kind of calibration: what it needs, its start, its progress, its result.
import { button, element, heldButton, setText } from "../shared/elements.js";
import { holdButton } from "../shared/hold.js";

const RUNS = ["asked", "running", "silent"];
const LEVELS = { waiting: "good", done: "good", failed: "bad", silent: "warn", unknown: "warn" };

export function makeKind(box, page, { kind, needs, sails = false, keeps = false, extra = null }) {
  const { words, go, live } = page;
  const title = words.say(`calibrate.${kind}`);
  const lines = needs.map(() => element("li"));
  const ask = (what, key) => go.ask(what, {}, `${title}: ${words.say(key)}`);
  const begin = () => ask(`calibrate_${kind}`, "calibrate.start");
  const start = sails
    ? heldButton("i-arm", words.say("calibrate.start_sailing"), { "aria-label": words.say("calibrate.start.of", { name: title }) })
    : button(words.say("calibrate.start"), begin, { "aria-label": words.say("calibrate.start.of", { name: title }) });
  if (sails) {
    start.classList.add("return");
    holdButton(start, begin, title, words, go.tell);
  }
  const keep = button(words.say("calibrate.keep"), () => ask("calibrate_accept", "calibrate.keep"), { className: "strong" });
  const cancel = button(words.say("calibrate.cancel"), () => ask("calibrate_cancel", "calibrate.cancel"));
  const fields = element("fieldset", { className: "calibrate-buttons" }, start, keep, cancel);
  fields.append(element("legend", { className: "unseen", text: title }));
  const told = element("p", { className: "calibrate-told", role: "status" });
  const bar = element("progress", { max: 100, "aria-label": words.say("calibrate.progress", { name: title }) });
  const share = element("span", { className: "calibrate-share", "aria-hidden": "true" });
  const progress = element("div", { className: "calibrate-progress" }, bar, share);
  const figures = element("ul", { className: "calibrate-figures" });
  const more = element("div");
  const part = extra?.(more, page) ?? null;
  const article = element(
    "section",
    { className: "calibration", data: { kind } },
    element("h3", { text: title }),
    element("p", { className: "calibrate-about", text: words.say(`calibrate.${kind}.about`) }),
    sails ? element("p", { className: "calibrate-warning", text: words.say("calibrate.sails") }) : null,
    element("ul", { className: "calibrate-needs" }, ...lines),
    told, progress, more, figures, fields,
  );
  article.setAttribute("aria-label", title);
  box.append(article);

  const show = (state) => {
    const latest = state.calibration ?? null;
    const own = latest?.kind === kind ? latest : null;
    const runs = own !== null && RUNS.includes(own.state);
    const isBusy = latest !== null && RUNS.includes(latest.state);
    article.dataset.state = own?.state ?? "";
    article.dataset.level = LEVELS[own?.state] ?? "";
    let isMet = true;
    needs.forEach(([key, holds], index) => {
      const met = holds(state);
      isMet &&= met;
      setText(lines[index], `${met ? "✓" : "✕"} ${words.say(key)}`);
      lines[index].dataset.met = String(met);
    });
    lines.forEach((line) => (line.hidden = runs));
    setText(told, own === null ? "" : said(own));
    progress.hidden = !runs;
    if (runs && own.percent !== undefined) {
      bar.value = own.percent;
      setText(share, words.percent(own.percent / 100));
    } else {
      bar.removeAttribute("value");
      setText(share, "");
    }
    showFigures(own);
    fields.disabled = !(live.isConnected && live.isSkipper);
    start.hidden = runs || own?.state === "waiting";
    start.disabled = isBusy || !isMet;
    keep.hidden = !keeps || !["waiting", "silent", "unknown"].includes(own?.state);
    cancel.hidden = !runs && own?.state !== "waiting";
    setText(cancel, words.say(own?.state === "waiting" ? "calibrate.drop" : "calibrate.cancel"));
    part?.show(state, runs);
  };

  // What to do, or how it ended; the boat's own words last.
  function said(own) {
    const first = words.sayOr(`calibrate.state.${own.state}`, own.state);
    if (own.state === "running") return words.say(`calibrate.${kind}.running`);
    if (own.state === "silent") return `${first} ${words.say(`calibrate.${sails ? "sailing" : kind}.silent`)}`;
    const text = words.told(own);
    return text ? `${first} ${text}` : first;
  }

  let figuresShown = "";
  function showFigures(own) {
    const texts = [];
    if (own?.error_mg !== undefined) texts.push(words.say("calibrate.error", { n: words.number(own.error_mg, 1) }));
    if (own?.offset_mg) texts.push(words.say("calibrate.offset", { xyz: own.offset_mg.map((one) => words.number(one)).join(", ") }));
    texts.push(...(own?.lines ?? []));
    const key = texts.join("\n");
    if (key === figuresShown) return;
    figuresShown = key;
    figures.replaceChildren(...texts.map((text) => element("li", { text })));
  }
  return { show, closed: () => part?.closed() };
}
