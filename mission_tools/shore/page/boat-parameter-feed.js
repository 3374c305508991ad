// The boat's parameters from the server, asked for while the panel is open: the boat sends them only then.

const PERIOD_MS = 1_000; // the server forgets after 3 s that somebody looks
const PATIENCE_MS = 10_000;

// show: {boat} with list ({missing, texts, parameters}, when it has changed), progress ({got, count}), refusal or isLost.
export function watchParameters(page, show) {
  let timer = null;
  let watch = 0; // an answer to an earlier opening is dropped
  let shown = ""; // the list's tag, with the boat

  const look = async (own) => {
    const boat = page.live.boat;
    const news = boat === null ? null : await ask(boat);
    if (own !== watch) return;
    if (news !== null && boat === page.live.boat) {
      shown = news.tag ?? "";
      show(news);
    }
    timer = setTimeout(look, PERIOD_MS, own);
  };

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

  const stop = () => {
    watch += 1;
    clearTimeout(timer);
  };
  return {
    opened() {
      stop();
      look(watch);
    },
    closed: stop,
  };
}
