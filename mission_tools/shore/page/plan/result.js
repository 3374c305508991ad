// The plan that the server found: its figures and warnings, upload, start, and files of it.
import { button, element, heldButton, pair, setText, ticked } from "../shared/elements.js";
import { holdButton } from "../shared/hold.js";

export const FORMATS = [["plan", ".plan"], ["waypoints", ".waypoints"], ["kml", "KML"], ["gpx", "GPX"], ["geojson", "GeoJSON"]];

export function figures({ length_m, time_s, charge_percent, clearance_m, items }, words) {
  return [
    ["plan.length", words.distance(length_m)],
    ["plan.time", time_s == null ? null : words.duration(time_s)],
    ["plan.charge", charge_percent == null ? null : words.percent(charge_percent / 100)],
    ["plan.clearance", clearance_m == null ? null : words.distance(clearance_m)],
    ["plan.items", words.number(items)],
  ].filter(([, value]) => value !== null);
}

const CLICK_MS = 100; // a browser sends the click of a finger so long after it was lifted, at most

// One sentence for the bar at the bottom, which screen readers read.
export function summary(plan, words) {
  const said = figures(plan, words).slice(0, 2).map(([, value]) => value);
  const count = plan.warnings.length;
  const more = [plan.fits === false ? "plan.no_charge" : "", count === 1 ? "plan.noted_one" : count > 1 ? "plan.noted" : ""];
  return [words.say("plan.found", { figures: said.join(", ") }), ...more.filter(Boolean).map((key) => words.say(key, { count }))].join(" ");
}

export const files = (address, label, words) =>
  element(
    "div",
    { className: "files", role: "group", "aria-label": label },
    element("span", { text: label }),
    ...FORMATS.map(([ending, text]) =>
      element("a", { href: `${address}.${ending}`, download: "", text, "aria-label": words.say("plan.save", { what: label, format: text }) }),
    ),
  );

// may(): whether a request can be sent now; says why not.
export function makeResult(box, draft, page, may) {
  const { words, go } = page;
  const old = element("p", { className: "old-plan", text: words.say("plan.old") });
  const replaced = element("p", { className: "replaced" });
  const told = element("div", {});
  const watch = element("div", { className: "watch" }, element("span", {}), element("a", { className: "strong", href: "#sail", text: words.say("plan.watch") }));
  let shown = null;
  let isSending = false;

  const send = async (start, name) => {
    const plan = draft.result;
    if (isSending || plan === null || !may()) return;
    isSending = true;
    show();
    const answer = await go.ask("upload_plan", { plan: plan.id, start, with_areas: areas.checked && plan.has_areas === true }, name);
    await letGo(); // else what appears under the finger is pressed by it
    isSending = false;
    if (draft.result === plan && answer.ok === true) {
      const isDisarmed = page.live.snapshot?.armed === false;
      plan.sent = start ? (isDisarmed ? "plan.then_arm" : "plan.sails") : isDisarmed ? "plan.then_arm_start" : "plan.then_start";
      draft.save();
    }
    show();
    if (answer.ok === true) watch.lastChild.focus();
  };
  const upload = button(words.say("plan.upload"), () => send(false, words.say("plan.upload")));
  const start = heldButton("i-sail", words.say("plan.start"), { className: "strong" });
  const startName = words.say("plan.start");
  const letGo = released(start);
  holdButton(start, () => send(true, startName), startName, words, go.tell);
  const buttons = element("div", { className: "row" }, upload, start);
  const { tick: areas, label: withAreas } = ticked(words.say("plan.with_areas"), "switch", true); // of an imported .plan

  const tell = (plan) => {
    const list = figures(plan, words).map(([label, value]) => pair(words.say(label), value));
    const notes = plan.warnings.map((text) => element("li", { text }));
    told.replaceChildren(
      element("h2", { text: plan.asked === null ? words.say("plan.imported", { name: plan.name }) : words.say("plan.planned") }),
      element("dl", {}, ...list),
      plan.fits === false ? element("p", { className: "no-charge", text: words.say("plan.no_charge") }) : "",
      notes.length > 0 ? element("ul", { className: "notes" }, ...notes) : "",
    );
    links.replaceChildren(files(`/api/plans/${encodeURIComponent(plan.id)}`, words.say("plan.save_plan"), words));
  };
  const links = element("div", {});
  box.append(told, old, withAreas, replaced, buttons, watch, links);

  const show = () => {
    const plan = draft.result;
    box.hidden = plan === null;
    if (plan === null) return;
    if (plan !== shown) {
      shown = plan;
      tell(plan);
    }
    const isCurrent = draft.isCurrent(page.live.boat);
    old.hidden = isCurrent;
    withAreas.hidden = plan.has_areas !== true;
    setText(replaced, plan.sent ? "" : words.replaces(page.live.snapshot));
    links.hidden = !page.live.isSkipper;
    replaced.hidden = !isCurrent || replaced.textContent === "";
    upload.disabled = start.disabled = !isCurrent || isSending;
    watch.hidden = !plan.sent;
    if (plan.sent) setText(watch.firstChild, words.say(plan.sent));
  };
  return show;
}

// A function that resolves when no finger is on the button, and its click is over.
function released(button) {
  let isDown = false;
  let resolve = () => {};
  button.addEventListener("pointerdown", () => (isDown = true));
  for (const name of ["pointerup", "pointercancel"])
    addEventListener(name, () => {
      isDown = false;
      setTimeout(() => resolve(), CLICK_MS);
    });
  return () => (isDown ? new Promise((done) => (resolve = done)) : Promise.resolve());
}
