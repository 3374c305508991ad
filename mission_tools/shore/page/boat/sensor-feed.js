// The sensors of the boat, fetched while a panel looks at them.
import { polled } from "../shared/poll.js";

const PERIOD_MS = 400;

// show(sensors): the list, or null where the server did not answer. Returns what a panel wants to hear.
export const watchSensors = (page, show) =>
  polled(PERIOD_MS, async (isCurrent) => {
    let sensors = null;
    try {
      const answer = await fetch(`/api/boats/${page.live.boat ?? 0}/sensors`, { signal: AbortSignal.timeout(4_000) });
      if (answer.ok) sensors = await answer.json();
    } catch {
      // told by null
    }
    if (isCurrent()) show(sensors);
  });
