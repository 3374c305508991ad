// The WebSocket to the server: reconnects with back-off, merges patches, and asks without doing anything twice.

const FIRST_WAIT_MS = 500;
const LONGEST_WAIT_MS = 4_000;
const SILENCE_MS = 6_000; // a lost Wi-Fi does not close a socket; a boat that is heard changes heard_s every second
const LONGEST_OPENING_MS = 48_000; // of a server that is slow to answer: each try waits twice as long as the last
const REQUEST_MS = 20_000; // the server answers within 10 s; a request is not repeated later than this
const LONGER_MS = { upload_plan: 300_000 }; // a long plan over a bad link takes minutes

// crypto.randomUUID exists on https and localhost only; the boat is on plain http.
export function requestId(random = globalThis.crypto) {
  if (random.randomUUID) return random.randomUUID();
  const bytes = random.getRandomValues(new Uint8Array(16));
  bytes[6] = (bytes[6] & 0x0f) | 0x40;
  bytes[8] = (bytes[8] & 0x3f) | 0x80;
  const hex = Array.from(bytes, (byte) => byte.toString(16).padStart(2, "0")).join("");
  return [hex.slice(0, 8), hex.slice(8, 12), hex.slice(12, 16), hex.slice(16, 20), hex.slice(20)].join("-");
}

export function liveAddress(place, boat) {
  const scheme = place.protocol === "https:" ? "wss:" : "ws:";
  return `${scheme}//${place.host}/live${boat === null ? "" : `?boat=${boat}`}`;
}

export class Live {
  // listeners: hello(message), state(snapshot, patch), link(), called when something changed; told(answer): its text.
  constructor(listeners, { open, now = () => performance.now(), boat = null } = {}) {
    this.listeners = listeners;
    this.open = open ?? ((chosen) => new WebSocket(liveAddress(location, chosen)));
    this.now = now;
    this.boat = boat;
    this.snapshot = null;
    this.hello = null;
    this.heardMs = null; // when the server was last heard
    this.waiting = new Map(); // requests without an answer, by id
    this.socket = null;
    this.isGreeted = false;
    this.isWhole = false; // the first state of a socket is whole
    this.waitMs = FIRST_WAIT_MS;
    this.openingMs = SILENCE_MS; // from opening a socket to its greeting, at most
    this.retryMs = 0;
  }

  get isConnected() {
    return this.socket !== null && this.socket.readyState === 1 && this.isGreeted;
  }

  get isSkipper() {
    return this.hello?.role === "skipper";
  }

  connect() {
    this.#drop();
    this.#giveUp((request) => request.isFleeting);
    const socket = this.open(this.boat);
    this.socket = socket;
    this.isGreeted = false;
    this.isWhole = false;
    this.openedMs = this.now();
    socket.onmessage = (event) => socket === this.socket && this.#handle(event.data);
    socket.onclose = () => socket === this.socket && this.#lost();
    this.listeners.link();
  }

  choose(boat) {
    this.boat = boat;
    this.snapshot = null;
    this.#giveUp((request) => request.boat !== boat);
    this.connect();
    this.listeners.state({}, {}); // nothing of the boat before stays
  }

  // Resolves to {ok, text, result}, once. ok is null where it is not known whether the request was done.
  // isFleeting: not sent again on a new connection, as it is of this moment only.
  ask(what, withThese = {}, { isFleeting = false } = {}) {
    return new Promise((resolve) => {
      if (!this.isConnected) {
        resolve({ ok: false, text: "", lost: true });
        return;
      }
      const request = { type: "do", id: requestId(), boat: this.boat, what, with: withThese };
      this.waiting.set(request.id, { request, resolve, boat: this.boat, isFleeting, untilMs: this.now() + (LONGER_MS[what] ?? REQUEST_MS) });
      this.socket.send(JSON.stringify(request));
    });
  }

  // Called a few times a second.
  tick() {
    const now = this.now();
    this.#giveUp((request) => now > request.untilMs);
    if (this.socket === null) {
      if (now >= this.retryMs) this.connect();
    } else if (now - Math.max(this.heardMs ?? 0, this.openedMs) > (this.isGreeted ? SILENCE_MS : this.openingMs)) {
      if (!this.isGreeted) this.openingMs = Math.min(this.openingMs * 2, LONGEST_OPENING_MS);
      this.#lost();
    }
    this.listeners.link();
  }

  // The network is back, or the page is looked at again: no need to wait.
  hurry() {
    this.waitMs = FIRST_WAIT_MS;
    if (this.socket === null) this.connect();
  }

  #handle(text) {
    let message;
    try {
      message = JSON.parse(text);
    } catch {
      return;
    }
    this.heardMs = this.now();
    if (message.type === "hello") this.#greet(message);
    else if (message.type === "state") this.#state(message);
    else if (message.type === "answer") this.#answer(message);
  }

  #greet(message) {
    this.hello = message;
    this.waitMs = FIRST_WAIT_MS;
    this.openingMs = SILENCE_MS;
    if (!this.isGreeted) for (const { request } of this.waiting.values()) this.socket.send(JSON.stringify(request));
    this.isGreeted = true; // a later greeting tells of another role or boat
    this.listeners.hello(message);
  }

  #state(message) {
    if (this.boat === null) this.boat = message.boat;
    if (message.boat !== this.boat) return;
    this.snapshot = merged(this.isWhole ? this.snapshot : {}, message.patch);
    this.isWhole = true;
    this.listeners.state(this.snapshot, message.patch);
  }

  #answer(message) {
    const request = this.waiting.get(message.id);
    if (request === undefined) return;
    this.waiting.delete(message.id);
    const text = this.listeners.told?.(message) ?? message.text;
    request.resolve({ ok: message.ok, text, result: message.result ?? null });
  }

  #giveUp(isOver) {
    for (const [id, request] of this.waiting) {
      if (!isOver(request)) continue;
      this.waiting.delete(id);
      request.resolve({ ok: null, text: "", result: null });
    }
  }

  #lost() {
    this.#drop();
    this.#giveUp((request) => request.isFleeting);
    this.retryMs = this.now() + this.waitMs * (0.75 + Math.random() / 2); // not all pages at once
    this.waitMs = Math.min(this.waitMs * 2, LONGEST_WAIT_MS);
    this.listeners.link();
  }

  #drop() {
    const socket = this.socket;
    this.socket = null;
    if (socket === null) return;
    socket.onmessage = socket.onclose = null;
    socket.close();
  }
}

// RFC 7396 merge patch: returns what `whole` becomes; neither is changed.
export function merged(whole, patch) {
  if (patch === null || typeof patch !== "object" || Array.isArray(patch)) return patch;
  const kept = whole !== null && typeof whole === "object" && !Array.isArray(whole) ? whole : {};
  const result = { ...kept };
  for (const [name, value] of Object.entries(patch)) {
    if (value === null) delete result[name];
    else result[name] = merged(result[name], value);
  }
  return result;
}

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
