// A place of the draft that lies on land: said at once, with the nearest water as an offer.
import { Plane } from "../shared/chart-view.js";
import { button, element, setText } from "../shared/elements.js";

// Returns look(): whether a tap has just put a place on land. changed(): the draft's places are others now.
export function makeAshore(draft, page, changed) {
  const { words, live, go } = page;
  const text = element("p", { role: "status" });
  const move = button(words.say("plan.ashore.move"), () => act(), { className: "strong" });
  const leave = button(words.say("plan.ashore.leave"), () => (box.hidden = true));
  const box = element("div", { className: "offer", role: "group", "aria-label": words.say("plan.ashore.title"), hidden: true }, text, move, leave);
  let offered = null; // {places, n, nearest}

  const act = () => {
    box.hidden = true;
    if (offered.places !== draft.here) return;
    draft.change(draft.here.map((place, n) => (n === offered.n ? offered.nearest : place)));
    changed();
    go.tell(words.say("plan.ashore.moved", { name: offered.name }), true);
  };

  const look = async () => {
    box.hidden = true;
    const places = draft.here;
    const n = places.length - 1;
    const [lon, lat] = places[n];
    if (!page.chart?.isAshore(lat, lon)) return;
    const name = words.say(draft.task === "survey" ? "plan.corner" : "plan.place", { n: n + 1 });
    const said = words.say("plan.ashore", { name });
    go.tell(said, false);
    if (draft.task === "survey" || !live.isSkipper || !live.isConnected) return; // a corner may well lie on land
    const { result } = await live.ask("route", { lat, lon });
    if (draft.here !== places || !result?.nearest) return;
    const nearest = [result.nearest.lon, result.nearest.lat].map((degrees) => Number(degrees.toFixed(7)));
    offered = { places, n, name, nearest };
    setText(text, words.say("plan.ashore.nearest", { name, length: words.distance(Math.hypot(...new Plane(lon, lat).to(nearest))) }));
    box.hidden = false;
  };
  return { box, look, showPlaces: () => offered?.places !== draft.here && (box.hidden = true) };
}
