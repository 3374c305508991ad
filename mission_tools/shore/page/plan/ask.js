// Asks the server for a plan: one at a time, with the seconds that pass, and can be cancelled.
import { refusal } from "../shared/pin.js";

const MOST_MS = 120_000;

// show(seconds): called each second, and with null at the end.
export class Planner {
  constructor(show, words) {
    this.show = show;
    this.words = words;
    this.stop = null;
  }

  get isBusy() {
    return this.stop !== null;
  }

  cancel() {
    this.stop?.abort("cancelled");
  }

  // Resolves to the plan, or to {why: "cancelled" | "late" | "lost" | "refused", text}.
  async ask(address, body, type) {
    const stop = new AbortController();
    const begun = performance.now();
    const late = setTimeout(() => stop.abort("late"), MOST_MS);
    const second = setInterval(() => this.show(Math.round((performance.now() - begun) / 1000)), 1000);
    this.stop = stop;
    this.show(0);
    try {
      const answer = await fetch(address, { method: "POST", headers: { "Content-Type": type }, body, signal: stop.signal });
      if (!answer.ok) return { why: "refused", text: await refusal(answer, this.words) };
      return { plan: await answer.json() };
    } catch {
      return { why: stop.signal.aborted ? stop.signal.reason : "lost" };
    } finally {
      clearTimeout(late);
      clearInterval(second);
      this.stop = null;
      this.show(null);
    }
  }
}

// Whether the server has forgotten the plan; while it is not heard, it has not.
export async function isForgotten(id) {
  try {
    return [404, 410].includes((await fetch(`/api/plans/${encodeURIComponent(id)}.geojson`)).status);
  } catch {
    return false;
  }
}
