// Fetches what the chart shows: the map once, lists when their version changes, the track on each connection.

const KINDS = ["mission", "fence", "rally"];
const RETRY_S = 2;
const LEAST_STEP_DEG = 5e-6; // half a metre
const MOST_POINTS = 2_000;

export class ChartData {
  constructor(chart) {
    this.chart = chart;
    this.hasMap = false;
    this.boat = null;
    this.versions = {};
    this.retryAt_s = {};
    this.points = [];
  }

  // On each connection: the chart may have missed some.
  async connected(boat) {
    if (boat !== this.boat) this.#clear();
    this.boat = boat;
    this.versions = {};
    this.retryAt_s = {};
    if (!this.hasMap) {
      const map = await fetched("/api/chart");
      if (map !== null) {
        this.hasMap = true;
        this.chart.showChart(map);
      }
    }
    const track = await fetched(`/api/boats/${boat}/track`);
    if (track === null || boat !== this.boat) return;
    this.points = Array.isArray(track) ? track : lineOf(track);
    this.chart.showTrack(this.points);
  }

  showState(state, now_s) {
    this.chart.showState(state);
    if (state.place) this.#addToTrack(state.place);
    for (const kind of KINDS) {
      const version = state[kind]?.version;
      if (version === undefined || version === this.versions[kind] || now_s < (this.retryAt_s[kind] ?? 0)) continue;
      this.retryAt_s[kind] = now_s + RETRY_S;
      this.#fetchItems(kind, version);
    }
  }

  #clear() {
    for (const kind of KINDS) this.chart.showItems(kind, null);
    this.points = [];
    this.chart.showTrack(this.points);
    this.chart.showWay(null);
  }

  async #fetchItems(kind, version) {
    const boat = this.boat;
    const items = await fetched(`/api/boats/${boat}/${kind}`);
    if (items === null || boat !== this.boat) return; // not downloaded yet: asked again with a later state
    this.versions[kind] = version;
    this.chart.showItems(kind, items);
  }

  #addToTrack({ lat, lon }) {
    const last = this.points[this.points.length - 1];
    if (last && Math.abs(last[0] - lon) < LEAST_STEP_DEG && Math.abs(last[1] - lat) < LEAST_STEP_DEG) return;
    this.points.push([lon, lat]);
    if (this.points.length > MOST_POINTS) this.points = this.points.filter((_, index) => index % 2 === 0);
    this.chart.showTrack(this.points);
  }
}

const lineOf = (track) => (track.features?.[0] ?? track).geometry?.coordinates ?? track.coordinates ?? [];

async function fetched(address) {
  try {
    const answer = await fetch(address);
    return answer.status === 200 ? await answer.json() : null;
  } catch {
    return null;
  }
}
