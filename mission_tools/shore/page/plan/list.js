// The places of the draft as a list: each can be moved and removed, by keyboard too.
import { button, element } from "../shared/elements.js";
import { legs } from "./draft.js";

// changed(): the draft's places are others now.
export function makeList(box, draft, page, changed) {
  const { words } = page;
  const list = element("ol", { className: "places", role: "list", "aria-label": words.say("plan.places") });
  box.append(list);
  let shown = "";

  const moved = (from, to) => {
    const places = draft.here.slice();
    places.splice(to, 0, ...places.splice(from, 1));
    return places;
  };
  const act = (places, n, name) => {
    draft.change(places);
    changed();
    const row = list.children[Math.min(n, list.children.length - 1)];
    const next = row?.querySelector(`[data-does=${name}]:enabled`) ?? row?.querySelector("button:enabled");
    (next ?? box.querySelector("summary"))?.focus({ preventScroll: true });
  };

  const row = (n, far_m, last) => {
    const values = { n: n + 1 };
    const name = words.say(draft.task === "survey" ? "plan.corner" : "plan.place", values);
    const far = far_m === null ? "" : words.say(n === 0 ? "plan.from_boat" : "plan.from_last", { length: words.distance(far_m) });
    const does = (what, sign, label, act_, off = false) =>
      button(sign, act_, { className: "square", data: { does: what }, disabled: off, "aria-label": words.say(label, { name }) });
    return element(
      "li",
      {},
      element("span", { className: "badge", text: String(n + 1), "aria-hidden": "true" }),
      element("span", { className: "what" }, element("b", { text: name }), element("span", { text: far })),
      does("up", "↑", "plan.up", () => act(moved(n, n - 1), n - 1, "up"), n === 0),
      does("down", "↓", "plan.down", () => act(moved(n, n + 1), n + 1, "down"), n === last),
      does("remove", "✕", "plan.remove", () => act(draft.here.filter((_, other) => other !== n), n, "remove")),
    );
  };

  // place: of the boat, or undefined. Rebuilt only when a text changes: the focus stays.
  return (place) => {
    const far = legs(draft.here, draft.task === "route" && place ? [place.lon, place.lat] : null);
    const key = JSON.stringify([draft.task, far.map((m) => m && words.distance(m))]);
    if (key === shown) return;
    const had = list.contains(document.activeElement) ? document.activeElement : null;
    const at = had === null ? -1 : [...list.children].indexOf(had.closest("li"));
    shown = key;
    list.replaceChildren(...far.map((m, n) => row(n, m, far.length - 1)));
    if (at >= 0) list.children[at]?.querySelector(`[data-does=${had.dataset.does}]`)?.focus({ preventScroll: true });
  };
}
