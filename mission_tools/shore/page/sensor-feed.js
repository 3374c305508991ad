// The sensors of the boat, fetched while a panel looks at them.

const PERIOD_MS = 400;

// show(sensors): the list, or null where the server did not answer. Returns what a panel wants to hear.
export function watchSensors(page, show) {
  let timer = null;
  let watch = 0; // an answer to an earlier opening is dropped

  const look = async (own) => {
    let sensors = null;
    try {
      const answer = await fetch(`/api/boats/${page.live.boat ?? 0}/sensors`, { signal: AbortSignal.timeout(4_000) });
      if (answer.ok) sensors = await answer.json();
    } catch {
      // told by null
    }
    if (own !== watch) return;
    show(sensors);
    timer = setTimeout(look, PERIOD_MS, own);
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
