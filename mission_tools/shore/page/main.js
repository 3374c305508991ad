// Wires the page: words, socket, and a module for each part.
import { setText } from "./shared/elements.js";
import { ChartData } from "./shared/chart-data.js";
import { chosenBoat, makeFleet, SILENT_S } from "./sail/fleet.js";
import { makeGoThere } from "./sail/go-there.js";
import { makeGo } from "./sail/go.js";
import { BoatClock, Live } from "./shared/live.js";
import { makeMessages } from "./sail/messages.js";
import { makeNow } from "./sail/now.js";
import { wirePin } from "./shared/pin.js";
import { wireTheme } from "./shared/theme.js";
import { wireViews } from "./shared/views.js";
import { makeWhy } from "./sail/why.js";
import { languageOf, Words } from "./shared/words.js";

const TICK_MS = 500;
const at = (id) => document.getElementById(id);
const now_s = () => Date.now() / 1000;

async function loadWords() {
  const language = languageOf(navigator.languages, (document.documentElement.dataset.languages ?? "en").split(" "));
  for (;;) {
    try {
      const answer = await fetch(`words.${language}.json`);
      if (answer.ok) return new Words(await answer.json());
    } catch {
      // asked again
    }
    await new Promise((resolve) => setTimeout(resolve, 2000));
  }
}

async function loadChart(words) {
  try {
    const { makeChart } = await import("./shared/chart.js");
    return makeChart(at("chart"), words);
  } catch (error) {
    console.warn(error);
    at("chart").hidden = true;
    return null;
  }
}

async function start() {
  wireTheme(at("theme"));
  const words = await loadWords();
  document.documentElement.lang = words.language;
  document.title = words.say("page.title");
  words.fill(document);

  const clock = new BoatClock();
  const showNow = makeNow({ cells: at("cells"), more: at("now-more"), mode: at("mode"), armed: at("armed"), alarm: at("alarm") }, words);
  const showWhy = makeWhy({ box: at("why"), title: at("why-title"), first: at("why-first"), count: at("why-count"), list: at("why-list") }, words);
  const showMessages = makeMessages({ latest: at("latest"), list: at("lines") }, words, clock);
  const isWide = matchMedia("(min-width: 44rem)"); // as in style.css: there is room for all messages
  const openMessages = () => (at("messages-box").open = isWide.matches);
  isWide.addEventListener("change", openMessages);
  openMessages();
  let data = null;
  let hasValues = false;
  let views = null;

  const live = new Live({
    hello: (message) => {
      fleet.showBoats(message.boats);
      showLink();
      if (live.boat !== null) data?.connected(live.boat);
    },
    state: (state) => {
      clock.note(state.heard_s, now_s());
      showNow(state);
      if (!hasValues && state.mode !== undefined) {
        hasValues = true;
        performance.mark("values"); // how soon a visitor sees the boat
      }
      showWhy(state);
      showMessages(state);
      go.showState(state);
      views?.showState(state);
      data?.showState(state, now_s());
      if (data !== null && data.boat === null) data.connected(live.boat);
    },
    link: () => showLink(),
    told: words.told,
  }, { boat: chosenBoat(location) });

  const go = makeGo(
    {
      box: at("go"), buttons: at("buttons"), answer: at("answer"), hold: at("hold"), return: at("return"), stop: at("stop"),
      start: at("start"), pause: at("pause"), continue: at("continue"), arm: at("arm"), armText: at("arm-text"),
      slower: at("slower"), faster: at("faster"), speed: at("speed"), speedText: at("speed-text"),
      modes: at("modes"), setMode: at("set-mode"), more: at("go-more"),
    },
    words,
    live,
  );
  const showPin = wirePin({ form: at("pin-form"), field: at("pin"), submit: at("unlock"), lock: at("lock") }, words, live, go.tell);

  let linkShown = "";
  function showLink() {
    const heard_s = live.snapshot?.heard_s;
    const age_s = heard_s === undefined ? null : clock.age_s(heard_s, now_s());
    const isSilent = live.isConnected && (age_s === null || age_s > SILENT_S);
    const level = !live.isConnected ? "bad" : isSilent ? "warn" : "good";
    const silent = age_s === null ? "link.never" : "link.silent";
    const link = words.say(level === "good" ? "link.good" : level === "warn" ? silent : "link.lost");
    setText(at("link"), link);
    setText(at("heard"), level === "good" || age_s === null ? "" : words.say("link.last", { age: words.duration(age_s) }));
    at("link-box").dataset.level = level;
    document.body.classList.toggle("old", level !== "good");
    if (level !== linkShown) {
      linkShown = level;
      setText(at("link-news"), link);
    }
    chart?.showHeard(level === "good");
    go.showLink();
    showPin();
  }

  let chart = null;
  const fleet = makeFleet(
    {
      toggle: at("boats"), name: at("boats-name"), sign: at("boats-sign"), title: at("boat-name"), box: at("fleet"), list: at("fleet-list"),
      other: at("other"), otherText: at("other-text"), choose: at("other-choose"), cancel: at("other-cancel"),
    },
    words, live, go, () => chart,
  );
  addEventListener("online", () => live.hurry());
  document.addEventListener("visibilitychange", () => document.hidden || live.hurry());

  const there = makeGoThere(
    { box: at("there"), text: at("there-text"), sail: at("sail"), cancel: at("cancel") },
    words, live, go, (points) => chart?.showWay(points),
  );
  const page = { words, live, go, get chart() { return chart; }, get data() { return data; } };
  views = wireViews({ nav: at("views"), main: document.querySelector("main") }, page, there);
  live.connect();
  setInterval(() => live.tick(), TICK_MS);

  chart = await loadChart(words);
  if (chart !== null) {
    data = new ChartData(chart);
    const main = document.querySelector("main");
    chart.onTap((lat, lon) => (main.dataset.view === "sail" && fleet.tap(lat, lon)) || views.tap(lat, lon));
    if (live.boat !== null) data.connected(live.boat);
    if (live.snapshot !== null) data.showState(live.snapshot, now_s());
  }
}

start();
