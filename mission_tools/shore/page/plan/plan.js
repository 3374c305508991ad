// Plan: tap goals or outline an area, have a route or survey planned, look at it, upload it, start it.
import { button, element, setText } from "../shared/elements.js";
import { makeAshore } from "./ashore.js";
import { isForgotten, Planner } from "./ask.js";
import { area, Draft, MOST_PLACES } from "./draft.js";
import { makeList } from "./list.js";
import { makeOptions, makeTasks } from "./options.js";
import { files, makeResult, summary } from "./result.js";

const MOST_BYTES = 2_000_000; // of a file, as the server takes
const KINDS = ".plan,.waypoints,.kml,.gpx,.geojson";

export function makeView(box, page) {
  const { words, live, go } = page;
  const draft = new Draft();
  let drawnOn = null; // the chart, once it shows the draft
  let wasConnected = false;

  const planner = new Planner((seconds) => {
    progress.hidden = seconds === null;
    plan.disabled = seconds !== null;
    if (seconds !== null) setText(progress.firstChild, words.say("plan.planning", { seconds: words.number(seconds) }));
  }, words);

  const tasks = makeTasks(draft, page, changed);
  const hint = element("p", { className: "hint", role: "status" });
  const undo = button(words.say("plan.undo"), () => draft.undo() && changed());
  const clear = button(words.say("plan.clear"), () => {
    draft.result = null;
    draft.change([]);
    changed();
  });
  const plan = button(words.say("plan.plan"), ask, { className: "strong" });
  const progress = element("div", { className: "row progress", hidden: true }, element("span", {}), button(words.say("plan.cancel"), () => planner.cancel()));
  const result = element("section", { className: "result", "aria-label": words.say("plan.result"), hidden: true });
  const [places, placesBox] = folded("plan.places", true);
  const [options, optionsBox] = folded("plan.options", matchMedia("(min-width: 64rem)").matches);
  const [more, moreBox] = folded("plan.files", false);
  const ashore = makeAshore(draft, page, changed);
  box.append(tasks.made, hint, ashore.box, element("div", { className: "row" }, undo, clear, plan), progress, result, places, options, more);

  const showList = makeList(placesBox, draft, page, changed);
  const shownOptions = makeOptions(optionsBox, draft, page, changed);
  const showResult = makeResult(result, draft, page, mayAsk);
  const chooser = element("input", { type: "file", accept: KINDS, className: "unseen", tabindex: -1, "aria-hidden": "true", on: { change: importFile } });
  const onBoard = element("div", {});
  moreBox.append(button(words.say("plan.import"), () => mayAsk() && chooser.click()), chooser, onBoard);

  function folded(title, isOpen) {
    const inside = element("div", {});
    return [element("details", { open: isOpen }, element("summary", { text: words.say(title) }), inside), inside];
  }

  function hinted() {
    const count = draft.here.length;
    if (draft.task === "route") return words.say(count === 0 ? "plan.tap_goals" : count === 1 ? "plan.one_goal" : "plan.goals", { count });
    if (count === 0) return words.say("plan.tap_corners");
    if (count < 3) return words.say("plan.few_corners");
    return words.say("plan.area", { count, area: square(area(draft.here)) });
  }
  const square = (m2) => (m2 < 9_950 ? words.say("unit.m2", { n: words.number(m2) }) : words.say("unit.ha", { n: words.number(m2 / 10_000, 1) }));

  function draw() {
    drawnOn = page.chart;
    const line = draft.isCurrent(live.boat) ? draft.result.points : [];
    page.chart?.showDraft({ places: draft.here, isArea: draft.task === "survey", line });
  }

  function changed() {
    draft.save();
    tasks.show();
    setText(hint, hinted());
    undo.disabled = draft.undone.length === 0;
    clear.disabled = draft.here.length === 0 && draft.result === null;
    showList(live.snapshot?.place);
    shownOptions.show();
    showResult();
    ashore.showPlaces();
    draw();
  }

  // Whether the server can be asked; says why not.
  function mayAsk() {
    if (!live.isConnected) go.tell(words.say("plan.lost"), false);
    else if (!live.isSkipper) {
      go.tell(words.say("plan.viewer"));
      document.getElementById("pin").focus();
    } else return true;
    return false;
  }

  async function ask() {
    const fault = draft.fault();
    if (fault !== null) {
      const name = fault.field && words.say(fault.field.label);
      go.tell(words.say(fault.key, { ...fault.values, name }), false);
      if (fault.field) shownOptions.point(fault.field.name);
    } else if (mayAsk()) {
      const asked = JSON.stringify(draft.request());
      await fetchPlan(`/api/boats/${live.boat}/plan`, asked, "application/json", asked);
    }
  }

  async function importFile() {
    const file = chooser.files[0];
    if (file === undefined) return;
    if (file.size > MOST_BYTES) go.tell(words.say("plan.too_long", { name: file.name }), false);
    else await fetchPlan(`/api/boats/${live.boat}/plan/import?name=${encodeURIComponent(file.name)}`, file, "application/octet-stream", null);
    chooser.value = ""; // the same file can be chosen again
  }

  async function fetchPlan(address, body, type, asked) {
    if (planner.isBusy) return;
    const boat = live.boat;
    go.tell(words.say("plan.asked"));
    const found = await planner.ask(address, body, type);
    if (!found.plan) {
      const said = { cancelled: "plan.cancelled", late: "plan.late", lost: "plan.lost", refused: "plan.refused" };
      go.tell(found.text || words.say(said[found.why]), found.why === "cancelled" ? null : false);
      return;
    }
    if (asked === null && draft.here.length > 0) draft.change([]); // an imported plan is not of these places; undo brings them back
    draft.result = { ...found.plan, boat, asked };
    changed();
    go.tell(summary(found.plan, words), found.plan.fits !== false);
    if (box.hidden) return;
    page.chart?.lookAt([...found.plan.points, ...draft.here]);
    result.scrollIntoView({ block: "nearest" });
  }

  async function checkResult() {
    const kept = draft.result;
    if (kept === null || !(await isForgotten(kept.id)) || draft.result !== kept) return;
    draft.result = null;
    changed();
    go.tell(words.say("plan.forgotten"));
  }

  let boatShown = null;
  let countShown = null;
  let mayShown = null;
  function showOnBoard() {
    const count = live.snapshot?.mission?.count ?? 0;
    if (live.boat === boatShown && count === countShown && live.isSkipper === mayShown) return;
    [boatShown, countShown, mayShown] = [live.boat, count, live.isSkipper];
    const label = words.say("plan.save_mission", { count: words.number(count) });
    const hint = count === 0 ? "plan.no_mission" : live.isSkipper ? null : "plan.save_viewer";
    onBoard.replaceChildren(hint ? element("p", { className: "hint", text: words.say(hint) }) : files(`/api/boats/${live.boat}/mission`, label, words));
  }

  return {
    tap(lat, lon) {
      if (draft.here.length >= MOST_PLACES) return go.tell(words.say("plan.full", { most: MOST_PLACES }), false);
      draft.change([...draft.here, [Number(lon.toFixed(7)), Number(lat.toFixed(7))]]);
      changed();
      ashore.look();
    },
    opened() {
      changed();
      checkResult();
    },
    closed() {
      page.chart?.showDraft(null);
      page.chart?.lookBack();
      drawnOn = null;
    },
    showState() {
      if (live.isConnected && !wasConnected) checkResult();
      wasConnected = live.isConnected;
      if (drawnOn !== page.chart) draw();
      showList(live.snapshot?.place);
      showResult();
      showOnBoard();
    },
  };
}
