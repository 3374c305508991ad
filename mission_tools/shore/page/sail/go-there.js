// Go to a tapped place by the water: the server plans the way, the page shows it, and it is sailed when confirmed.
import { setText } from "../shared/elements.js";
import { Plane } from "../shared/chart-view.js";

const SAILING = ["AUTO", "GUIDED"];

export function makeGoThere(page, words, live, go, showWay) {
  let wanted = null; // what the button does: {what, with} asks that of the boat, {nearest} plans a way to that place
  let taps = 0;
  let sailed = null; // the way under way: shown until the boat leaves the mode in which it sails it
  let sailsIn = null; // that mode
  let boat = null; // whose way it is

  const close = () => {
    wanted = null;
    taps += 1;
    page.box.hidden = true;
    showWay(sailed);
  };
  const offer = (text, what) => {
    setText(page.text, text);
    setText(page.sail, words.say(what.nearest ? "there.to_nearest" : "there.sail"));
    wanted = what;
    page.box.hidden = false;
  };

  page.sail.addEventListener("click", async () => {
    if (wanted === null || boat !== live.boat) return close();
    const asked = wanted;
    if (asked.nearest) return tap(asked.nearest.lat, asked.nearest.lon);
    wanted = null;
    page.box.hidden = true;
    const answer = await go.ask(asked.what, asked.with, words.say("there.sail"));
    if (answer.ok === true) [sailed, sailsIn] = [asked.with.points ?? null, null];
    if (page.box.hidden) showWay(sailed);
  });
  page.cancel.addEventListener("click", () => {
    close();
    go.tell(words.say("there.cancelled"));
  });
  page.box.addEventListener("keydown", (event) => event.key === "Escape" && close());

  const tap = async (lat, lon) => {
    if (!live.isSkipper) return go.tell(words.say("there.viewer"));
    if (!live.isConnected) return go.tell(words.say("go.lost"), false);
    close();
    boat = live.boat;
    const number = taps;
    go.tell(words.say("there.planning"));
    const answer = await live.ask("route", { lat, lon });
    if (number !== taps) return; // another place was tapped meanwhile
    if (answer.ok !== true) {
      go.tell(answer.text || words.say("there.no_way"), false);
      const nearest = answer.result?.nearest; // the map says so: a straight way would end on land
      if (nearest) {
        const away_m = Math.hypot(...new Plane(lon, lat).to([nearest.lon, nearest.lat]));
        showWay([[nearest.lon, nearest.lat]]);
        offer(words.say("there.nearest", { length: words.distance(away_m) }), { nearest });
      } else if (!answer.lost) offer(words.say("there.direct"), { what: "go", with: { lat, lon } });
      return;
    }
    const { points, length_m, time_s } = answer.result;
    showWay(points);
    const values = { length: words.distance(length_m), time: time_s == null ? "" : words.duration(time_s) };
    const said = words.say(time_s == null ? "there.way" : "there.way_time", values);
    offer([said, words.replaces(live.snapshot)].filter(Boolean).join(" "), { what: "sail", with: { points } });
    go.tell(answer.text || words.say("there.planned"), true);
    page.sail.focus({ preventScroll: true });
  };

  const showState = ({ mode }) => {
    if (boat !== null && boat !== live.boat) {
      [boat, sailed] = [null, null];
      close();
    }
    if (sailed === null) return;
    if (SAILING.includes(mode)) sailsIn = sailsIn ?? mode;
    if (sailsIn === null || mode === sailsIn) return;
    sailed = null;
    if (page.box.hidden) showWay(null);
  };
  return { tap, showState };
}
