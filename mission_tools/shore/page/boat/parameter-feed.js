// The boat's parameters from the server, asked for while the panel is open: the boat sends them only then.
import { polled } from "../shared/poll.js";

const PERIOD_MS = 1_000; // the server forgets after 3 s that somebody looks
const PATIENCE_MS = 10_000;

// show: {boat} with list ({missing, texts, parameters}, when it has changed), progress ({got, count}), refusal or isLost.
export function watchParameters(page, show) {
  let shown = ""; // the list's tag, with the boat

  // null: nothing new.
  const ask = async (boat) => {
    try {
      const address = `/api/boats/${boat}/parameters`;
      const answer = await fetch(address, { cache: "no-cache", signal: AbortSignal.timeout(PATIENCE_MS) });
      const tag = `${boat} ${answer.headers.get("ETag")}`;
      if (answer.status === 200 && tag === shown) return null;
      const content = await answer.json();
      if (answer.status === 200) return { boat, tag, list: content };
      return answer.status === 202 ? { boat, progress: content } : { boat, refusal: page.words.refusal(content) };
    } catch {
      return { boat, isLost: true };
    }
  };

  return polled(PERIOD_MS, async (isCurrent) => {
    const boat = page.live.boat;
    const news = boat === null ? null : await ask(boat);
    if (!isCurrent() || news === null || boat !== page.live.boat) return;
    shown = news.tag ?? "";
    show(news);
  });
}
