// The map: water, land, islands, structures, keep-out areas, landmarks and their names.

const SOLID = ["island", "obstacle", "pier", "raft"];
const KEPT_OUT = ["keep_out", "swimming"];
const HATCH_PX = 9;

// The shapes of a GeoJSON map, prepared for the plane: {bounds, shapes: [{kind, name, path, middle, width_m, isArea}]}
export function prepare(geojson, plane) {
  const bounds = [Infinity, Infinity, -Infinity, -Infinity];
  const shapes = [];
  for (const feature of geojson.features ?? []) {
    const { kind = "water", name = "" } = feature.properties ?? {};
    const { type, coordinates } = feature.geometry ?? {};
    if (type === undefined) continue;
    const rings = (type === "Polygon" ? coordinates : type === "LineString" ? [coordinates] : [[coordinates]]).map((ring) =>
      ring.map((place) => plane.to(place)),
    );
    const own = box(rings[0]);
    if (kind === "water") widen(bounds, own);
    const path = new Path2D();
    for (const ring of rings) {
      ring.forEach(([east, north], n) => (n === 0 ? path.moveTo(east, north) : path.lineTo(east, north)));
      if (type === "Polygon") path.closePath();
    }
    const middle = type === "Polygon" ? centre(rings[0]) : [(own[0] + own[2]) / 2, (own[1] + own[3]) / 2];
    shapes.push({ kind, name, path, type, bounds: own, middle, point: rings[0][0] });
  }
  return { bounds: Number.isFinite(bounds[0]) ? bounds : null, shapes };
}

// Whether a place of the plane lies in some water and on nothing solid.
export function isWater(pen, map, [east, north]) {
  const isIn = ({ type, path }) => type === "Polygon" && pen.isPointInPath(path, east, north, "evenodd");
  pen.save();
  pen.resetTransform();
  const at = map.shapes.filter(isIn).map(({ kind }) => kind);
  pen.restore();
  return at.includes("water") && !at.some((kind) => SOLID.includes(kind) || KEPT_OUT.includes(kind));
}

// In metres: the context is scaled to them; `px` is a pixel in metres.
export function drawMap(pen, map, view, colour, px) {
  const seen = viewBox(view);
  const shown = map.shapes.filter((shape) => overlaps(shape.bounds, seen));
  pen.lineJoin = "round";
  for (const shape of shown) {
    if (shape.kind !== "water") continue;
    pen.fillStyle = colour.water;
    pen.fill(shape.path, "evenodd");
    stroke(pen, shape.path, colour.shore, (view.scale < 0.1 ? 0.7 : 1.4) * px); // far off it would hide narrow water
  }
  for (const shape of shown) {
    if (!KEPT_OUT.includes(shape.kind)) continue;
    pen.fillStyle = colour.keepFill;
    pen.fill(shape.path, "evenodd");
    hatch(pen, shape, seen, colour.keep, px);
    pen.setLineDash([6 * px, 4 * px]);
    stroke(pen, shape.path, colour.keep, 1.8 * px);
    pen.setLineDash([]);
  }
  for (const shape of shown) {
    if (!SOLID.includes(shape.kind)) continue;
    const isIsland = shape.kind === "island";
    pen.fillStyle = isIsland ? colour.island : colour.structure;
    if (shape.type === "Polygon") pen.fill(shape.path, "evenodd");
    if (shape.type === "Point") {
      pen.beginPath();
      pen.arc(...shape.point, 4 * px, 0, 2 * Math.PI);
      pen.fill();
    }
    stroke(pen, shape.path, isIsland ? colour.shore : colour.structureEdge, (shape.type === "Polygon" ? 1.2 : 3) * px);
  }
}

// In pixels. A name is left out where it would cover another or what `taken` holds.
export function drawNames(pen, map, view, colour, taken) {
  const rank = (shape) => (shape.kind === "landmark" ? 0 : KEPT_OUT.includes(shape.kind) ? 1 : 2);
  for (const shape of map.shapes.slice().sort((a, b) => rank(a) - rank(b))) {
    if (shape.name === "" || shape.kind === "water") continue;
    const isLandmark = shape.kind === "landmark";
    const [x, y] = view.toPixel(isLandmark ? shape.point : shape.middle);
    if (x < 0 || y < 0 || x > view.width || y > view.height) continue;
    if (isLandmark) {
      pen.fillStyle = colour.ink;
      pen.strokeStyle = colour.halo;
      pen.lineWidth = 1;
      pen.fillRect(x - 3.5, y - 3.5, 7, 7);
      pen.strokeRect(x - 3.5, y - 3.5, 7, 7);
    }
    pen.font = isLandmark ? "600 12px system-ui, sans-serif" : "italic 500 12px system-ui, sans-serif";
    const half = pen.measureText(shape.name).width / 2 + 3;
    const isStructure = ["pier", "raft", "obstacle"].includes(shape.kind);
    const down = isLandmark || isStructure ? 15 : 0;
    const middle = Math.min(Math.max(x, half), view.width - half); // whole where its thing is at the edge
    const own = [middle - half, y + down - 8, middle + half, y + down + 8];
    if (taken.some((other) => overlaps(own, other))) continue;
    taken.push(own);
    const isKept = KEPT_OUT.includes(shape.kind);
    text(pen, shape.name, middle, y + down, isKept ? colour.keep : colour.ink, colour.halo);
  }
}

// Where nothing is known of the water: squares of a round length.
export function drawGrid(pen, view, colour, step_m) {
  const [west, south, east, north] = viewBox(view);
  pen.beginPath();
  for (let at = Math.ceil(west / step_m) * step_m; at <= east; at += step_m) {
    const x = Math.round(view.toPixel([at, 0])[0]) + 0.5;
    pen.moveTo(x, 0);
    pen.lineTo(x, view.height);
  }
  for (let at = Math.ceil(south / step_m) * step_m; at <= north; at += step_m) {
    const y = Math.round(view.toPixel([0, at])[1]) + 0.5;
    pen.moveTo(0, y);
    pen.lineTo(view.width, y);
  }
  pen.strokeStyle = colour.grid;
  pen.lineWidth = 1;
  pen.stroke();
}

export function text(pen, words, x, y, colour, halo) {
  pen.textAlign = "center";
  pen.textBaseline = "middle";
  pen.lineJoin = "round";
  pen.strokeStyle = halo;
  pen.lineWidth = 3.5;
  pen.strokeText(words, x, y);
  pen.fillStyle = colour;
  pen.fillText(words, x, y);
}

export const overlaps = (a, b) => a[0] < b[2] && a[2] > b[0] && a[1] < b[3] && a[3] > b[1];

function viewBox(view) {
  const [west, north] = view.toMetres([0, 0]);
  const [east, south] = view.toMetres([view.width, view.height]);
  return [west, south, east, north];
}

function stroke(pen, path, colour, width) {
  pen.strokeStyle = colour;
  pen.lineWidth = width;
  pen.stroke(path);
}

// Diagonals inside a shape: told apart from water without its colour.
function hatch(pen, shape, seen, colour, px) {
  const [west, south, east, north] = [
    Math.max(shape.bounds[0], seen[0]), Math.max(shape.bounds[1], seen[1]),
    Math.min(shape.bounds[2], seen[2]), Math.min(shape.bounds[3], seen[3]),
  ];
  const height = north - south;
  const step = HATCH_PX * px * Math.SQRT2;
  pen.save();
  pen.clip(shape.path, "evenodd");
  pen.beginPath();
  // Lines of a fixed lattice, so that they stay on the water when the chart is moved
  for (let at = Math.floor((west - north) / step) * step; at <= east - south; at += step) {
    pen.moveTo(at + south, south);
    pen.lineTo(at + south + height, north);
  }
  pen.strokeStyle = colour;
  pen.globalAlpha = 0.4;
  pen.lineWidth = px;
  pen.stroke();
  pen.restore();
}

function box(points) {
  const found = [Infinity, Infinity, -Infinity, -Infinity];
  for (const [x, y] of points) widen(found, [x, y, x, y]);
  return found;
}

function widen(bounds, own) {
  bounds[0] = Math.min(bounds[0], own[0]);
  bounds[1] = Math.min(bounds[1], own[1]);
  bounds[2] = Math.max(bounds[2], own[2]);
  bounds[3] = Math.max(bounds[3], own[3]);
}

function centre(ring) {
  const corners = ring.slice(0, -1);
  const sum = corners.reduce(([x, y], [e, n]) => [x + e, y + n], [0, 0]);
  return [sum[0] / corners.length, sum[1] / corners.length];
}
