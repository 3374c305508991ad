// How long ago something happened on the boat, though the clocks of boat and phone differ.

export class BoatClock {
  #offset_s = null; // phone minus boat, the least seen: the least delayed
  #last_s = null;

  // heard_s: the boat's Unix time of its latest heartbeat. Only one that arrives just now tells the offset.
  note(heard_s, now_s) {
    if (heard_s === undefined || heard_s === this.#last_s) return;
    if (this.#last_s !== null) {
      const offset_s = now_s - heard_s;
      if (this.#offset_s === null || offset_s < this.#offset_s || offset_s > this.#offset_s + 60) this.#offset_s = offset_s;
    }
    this.#last_s = heard_s;
  }

  age_s(at_s, now_s) {
    return Math.max(0, now_s - at_s - (this.#offset_s ?? 0));
  }

  // As the phone's own clock shows it.
  local_s(at_s) {
    return at_s + (this.#offset_s ?? 0);
  }
}
