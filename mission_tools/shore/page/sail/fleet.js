// The boats, where there is more than one: a list of them in the header, the others on the chart, one chosen.
// The choice is in the page's address, so a reload keeps it.
import { element, setText } from "../shared/elements.js";

export const SILENT_S = 4; // of a boat: its heartbeat comes every second
const PERIOD_MS = 1_000;

// The boat that the address names, or null: then it is the first.
export function chosenBoat(address) {
  const number = Number(new URLSearchParams(address.search).get("boat"));
  return Number.isInteger(number) && number >= 1 && number <= 255 ? number : null;
}

function keep(boat) {
  const address = new URL(location.href);
  address.searchParams.set("boat", boat);
  history.replaceState(history.state, "", address);
}

// page: {toggle, name, sign, box, list, title, other, otherText, choose, cancel}. chart(): the chart, or null.
export function makeFleet(page, words, live, go, chart) {
  const rows = new Map();
  let boats = [];
  let heardMs = 0; // when the list came
  let isAsking = false;
  let offered = null;

  const nameOf = (boat) => words.say("boat.number", { n: boat.id });
  const ageOf = (boat) => (boat.age_s == null ? null : boat.age_s + (performance.now() - heardMs) / 1000);
  const isSilent = (boat) => !(ageOf(boat) < SILENT_S);
  const find = (id) => boats.find((boat) => boat.id === id);

  const open = (isOpen) => {
    page.box.hidden = !isOpen;
    page.toggle.setAttribute("aria-expanded", String(isOpen));
    if (!isOpen) return;
    show();
    (rows.get(live.boat) ?? [...rows.values()][0])?.button.focus();
  };
  const choose = (id) => {
    open(false);
    page.other.hidden = true;
    offered = null;
    page.toggle.focus({ preventScroll: true });
    if (id === live.boat) return;
    keep(id);
    live.choose(id);
    go.tell(words.say("fleet.chosen", { name: nameOf({ id }) }));
    chart()?.follow();
    show();
  };

  function makeRow(id) {
    const part = Object.fromEntries(["name", "state", "battery", "heard"].map((name) => [name, element("span", { className: name })]));
    const button = element("button", { type: "button", on: { click: () => choose(id) } }, ...Object.values(part));
    page.list.append(element("li", {}, button));
    return { button, part };
  }

  function show() {
    const isFleet = boats.length > 1 || (boats.length === 1 && live.boat !== null && live.boat !== boats[0].id);
    page.toggle.hidden = !isFleet;
    page.title.hidden = isFleet;
    const chosen = find(live.boat) ?? (live.boat === null ? boats[0] : { id: live.boat });
    const name = chosen === undefined ? words.say("page.title") : nameOf(chosen);
    setText(page.title, name);
    setText(page.name, name);
    setText(page.sign, boats.some(isSilent) ? words.say("fleet.some_silent") : "");
    for (const boat of boats) {
      if (!rows.has(boat.id)) rows.set(boat.id, makeRow(boat.id));
      showRow(rows.get(boat.id), boat);
    }
    const others = boats.filter((boat) => boat.id !== live.boat && boat.place);
    chart()?.showOthers(others.map((boat) => ({ id: boat.id, name: nameOf(boat), place: [boat.place.lon, boat.place.lat], heading_deg: boat.heading_deg })));
  }

  function showRow({ button, part }, boat) {
    const age_s = ageOf(boat);
    const armed = words.say(boat.armed == null ? "now.armed.none" : boat.armed ? "now.armed.yes" : "now.armed.no");
    const alarm = ["critical", "emergency"].includes(boat.state) ? words.say("fleet.alarm", { state: words.sayOr(`state.${boat.state}`, boat.state) }) : "";
    const mode = boat.mode == null ? words.say("now.mode.none") : words.sayOr(`mode.${boat.mode}`, boat.mode);
    setText(part.name, nameOf(boat));
    setText(part.state, [alarm, mode, armed].filter(Boolean).join(" · "));
    const battery = boat.left_s != null ? words.say("fleet.battery_time", { time: words.duration(boat.left_s) })
      : boat.percent != null ? words.say("fleet.battery", { share: words.percent(boat.percent / 100) }) : "";
    setText(part.battery, battery);
    const heard = age_s === null ? "fleet.never" : isSilent(boat) ? "fleet.silent" : "fleet.heard";
    setText(part.heard, words.say(heard, { age: words.duration(age_s ?? 0) }));
    button.classList.toggle("silent", isSilent(boat));
    button.setAttribute("aria-current", String(boat.id === live.boat));
  }

  const showBoats = (next) => {
    boats = next;
    heardMs = performance.now();
    show();
  };

  async function ask() {
    if (isAsking || document.hidden || !live.isConnected || page.toggle.hidden) return;
    isAsking = true;
    try {
      const answer = await fetch("/api/boats");
      if (answer.ok) showBoats(await answer.json());
    } catch {
      // asked again; the ages go on
    }
    isAsking = false;
  }

  page.toggle.addEventListener("click", () => open(page.box.hidden));
  page.box.addEventListener("keydown", (event) => {
    if (event.key !== "Escape") return;
    open(false);
    page.toggle.focus();
  });
  document.addEventListener("pointerdown", (event) => {
    if (!page.box.hidden && !page.box.contains(event.target) && !page.toggle.contains(event.target)) open(false);
  });
  page.choose.addEventListener("click", () => offered !== null && choose(offered));
  page.cancel.addEventListener("click", () => (page.other.hidden = true));
  setInterval(() => {
    show();
    ask();
  }, PERIOD_MS);

  return {
    showBoats,
    // A tapped place: whether another boat is there; then it is offered.
    tap(lat, lon) {
      const other = chart()?.otherAt(lat, lon) ?? null;
      offered = other?.id ?? null;
      page.other.hidden = other === null;
      if (other === null) return false;
      setText(page.otherText, words.say("fleet.here", { name: other.name }));
      setText(page.choose, words.say("fleet.choose", { name: other.name }));
      page.choose.focus({ preventScroll: true });
      return true;
    },
  };
}
