// Where places of the Earth are on the canvas: north up, metres round an origin, an exact inverse.

const A_M = 6378137;
const E2 = 0.00669437999014;
const LEAST_SCALE = 0.002; // pixels a metre
const WHOLE = 0.3; // of the canvas that the whole map takes at least
const MOST_SCALE = 1000;

// Metres east and north of an origin. Its scale is that of the origin's latitude: shapes stay true to 1 % within 60 km.
export class Plane {
  constructor(lon, lat) {
    const sine = Math.sin((lat * Math.PI) / 180);
    const w = Math.sqrt(1 - E2 * sine * sine);
    this.lon = lon;
    this.lat = lat;
    this.eastPerDegree = (((A_M / w) * Math.PI) / 180) * Math.max(Math.cos((lat * Math.PI) / 180), 1e-3);
    this.northPerDegree = (((A_M * (1 - E2)) / (w * w * w)) * Math.PI) / 180;
  }

  to([lon, lat]) {
    const away = ((((lon - this.lon + 180) % 360) + 360) % 360) - 180;
    return [away * this.eastPerDegree, (lat - this.lat) * this.northPerDegree];
  }

  from([east, north]) {
    const lon = this.lon + east / this.eastPerDegree;
    return [((((lon + 180) % 360) + 360) % 360) - 180, this.lat + north / this.northPerDegree];
  }
}

export class View {
  constructor() {
    this.middle = [0, 0]; // metres
    this.scale = 2; // pixels a metre
    this.leastScale = LEAST_SCALE;
    this.width = 1;
    this.height = 1;
  }

  toPixel([east, north]) {
    return [
      this.width / 2 + (east - this.middle[0]) * this.scale,
      this.height / 2 - (north - this.middle[1]) * this.scale,
    ];
  }

  toMetres([x, y]) {
    return [
      this.middle[0] + (x - this.width / 2) / this.scale,
      this.middle[1] - (y - this.height / 2) / this.scale,
    ];
  }

  pan(dx, dy) {
    this.middle = [this.middle[0] - dx / this.scale, this.middle[1] + dy / this.scale];
  }

  // The place under the pixel stays where it is.
  zoom(factor, at) {
    const [east, north] = this.toMetres(at);
    this.scale = Math.min(Math.max(this.scale * factor, this.leastScale), MOST_SCALE);
    const [x, y] = this.toPixel([east, north]);
    this.pan(at[0] - x, at[1] - y);
  }

  // From the farthest zoom on, the whole map keeps its share of the canvas.
  limit(bounds) {
    this.leastScale = Math.max(WHOLE * this.#fitting(bounds), LEAST_SCALE);
  }

  fit(bounds, share = 0.94) {
    const [west, south, east, north] = bounds;
    this.middle = [(west + east) / 2, (south + north) / 2];
    this.scale = Math.min(Math.max(share * this.#fitting(bounds), LEAST_SCALE), MOST_SCALE);
  }

  #fitting([west, south, east, north]) {
    return Math.min(this.width / Math.max(east - west, 0.1), this.height / Math.max(north - south, 0.1));
  }
}
