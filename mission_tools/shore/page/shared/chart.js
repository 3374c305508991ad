// The chart: map, boat, track, plan, on a canvas. It draws only when something changed.
import { currentRoom, drawBoat, drawCurrent, drawNorth, drawOther, drawScale, drawSenses, drawVessel, roundLength } from "./chart-boat.js";
import { colours } from "./chart-colours.js";
import { draftRoom, drawDraft } from "./chart-draft.js";
import { listen } from "./chart-input.js";
import { drawGrid, drawMap, drawNames, isWater, prepare, text } from "./chart-map.js";
import { drawCross, drawFence, drawMark, drawMissionItems, drawMissionLine, drawTrack, drawWay, placed } from "./chart-plan.js";
import { Plane, View } from "./chart-view.js";

const MOST_DENSITY = 3; // of pixels: beyond it the canvas costs more than it shows
const FOLLOW_SCALE = 2; // pixels a metre when the boat is first seen
const STILL_PX = 0.3; // the boat has moved when it is so far from where it was drawn
const MOST_AWAY_M = 60_000; // from the plane's origin
const OTHER_PX = 26; // a tap so near to another boat means it
const BUTTON_ZOOM = 1.6;
const LOOK_SHARE = 0.8; // of the canvas
const SHOWN = ["place", "heading_deg", "course_deg", "speed_m_s", "armed", "home", "progress", "current", "sonar", "obstacles", "vessels"];
const NONE = { type: "FeatureCollection", features: [] };

export function makeChart(canvas, words) {
  const pen = canvas.getContext("2d");
  const view = new View();
  const items = { mission: NONE.features, fence: NONE.features, rally: NONE.features };
  let plane = null; // from the first place that is known
  let geojson = NONE;
  let map = null; // prepared for the plane; null without water
  let state = {};
  let shown = "";
  let track = [];
  let trackPlaces = [];
  let way = null;
  let others = []; // boats besides the one that is watched: {id, name, place, heading_deg}
  let isHeard = true;
  let draft = null; // of the Plan view: shown in the place of the way
  let tapped = () => {};
  let isFollowing = true;
  let hasLookedAway = false; // from the boat that it followed
  let hasBoat = false;
  let frame = 0;

  const changed = () => {
    if (frame === 0) frame = requestAnimationFrame(draw);
  };
  const usePlane = (place) => {
    if (plane !== null && Math.hypot(...plane.to(place)) < MOST_AWAY_M) return;
    const middle = plane?.from(view.middle);
    plane = new Plane(...place);
    if (middle !== undefined) view.middle = plane.to(middle);
    map = prepare(geojson, plane);
    trackMetres();
  };
  const trackMetres = () => {
    track = plane === null ? [] : trackPlaces.map((place) => plane.to(place));
  };
  const follow = (isOn) => {
    isFollowing = isOn;
    hasLookedAway = false;
    tools.follow.setAttribute("aria-pressed", String(isOn));
    if (isOn) centre();
    changed();
  };
  const centre = () => {
    if (isFollowing && plane !== null && state.place) view.middle = plane.to([state.place.lon, state.place.lat]);
  };
  const middle = () => [view.width / 2, view.height / 2];
  // Zooming while the boat is followed keeps it in the middle
  const zoom = (factor, at) => {
    view.zoom(factor, isFollowing && hasBoat ? middle() : at);
    changed();
  };
  const tools = makeTools(canvas, words, {
    follow: () => follow(true),
    in: () => zoom(BUTTON_ZOOM, middle()),
    out: () => zoom(1 / BUTTON_ZOOM, middle()),
  });

  canvas.classList.add("chart-canvas");
  canvas.tabIndex = 0;
  canvas.setAttribute("role", "application");
  canvas.setAttribute("aria-label", words.say("chart.label"));
  listen(canvas, {
    pan: (dx, dy, isPinch) => {
      if (isPinch && isFollowing && hasBoat) return; // two fingers only zoom
      view.pan(dx, dy);
      follow(false);
    },
    zoom,
    tap: (at) => {
      if (plane === null) return;
      const [lon, lat] = plane.from(view.toMetres(at));
      tapped(lat, lon);
    },
    follow: () => follow(true),
    middle,
  });
  for (const name of ["focus", "blur"]) canvas.addEventListener(name, changed);
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", changed);
  new MutationObserver(changed).observe(document.documentElement, { attributeFilter: ["data-theme"] });
  new ResizeObserver(() => {
    const isFirst = view.width === 1;
    [view.width, view.height] = [Math.max(canvas.clientWidth, 1), Math.max(canvas.clientHeight, 1)];
    if (map?.bounds) view.limit(map.bounds);
    if (isFirst && map?.bounds && !hasBoat) view.fit(map.bounds);
    changed();
  }).observe(canvas);

  // The canvas has as many pixels as the screen.
  function sharpen() {
    const density = Math.min(devicePixelRatio || 1, MOST_DENSITY);
    const [width, height] = [Math.round(view.width * density), Math.round(view.height * density)];
    if (canvas.width !== width || canvas.height !== height) [canvas.width, canvas.height] = [width, height];
    return density;
  }

  function draw() {
    frame = 0;
    if (view.width <= 1) return; // hidden
    const density = sharpen();
    const colour = colours();
    const isCharted = map !== null && map.bounds !== null;
    pen.setTransform(density, 0, 0, density, 0, 0);
    pen.fillStyle = isCharted ? colour.land : colour.water;
    pen.fillRect(0, 0, view.width, view.height);
    const taken = [[0, 0, 48, 96], [view.width - 62, 0, view.width, 180], [0, view.height - 40, 140, view.height], ...currentRoom(pen, state.current, words)];
    if (isCharted) {
      const scale = density * view.scale;
      const [x, y] = view.toPixel([0, 0]);
      pen.setTransform(scale, 0, 0, -scale, density * x, density * y);
      drawMap(pen, map, view, colour, 1 / view.scale);
      pen.setTransform(density, 0, 0, density, 0, 0);
    } else drawGrid(pen, view, colour, roundLength(90, view.scale));
    if (plane === null) {
      pen.font = "600 15px system-ui, sans-serif";
      text(pen, words.say("chart.nothing"), ...middle(), colour.ink, colour.halo);
      return;
    }
    const pixel = ([lon, lat]) => view.toPixel(plane.to([lon, lat]));
    drawFence(pen, items.fence, plane, view, colour);
    if (draft === null && way !== null && way.length > 0) drawWay(pen, way.map(pixel), colour);
    const mission = placed(items.mission, plane, view);
    drawMissionLine(pen, mission, colour);
    drawTrack(pen, track.map((at) => view.toPixel(at)), colour);
    drawMissionItems(pen, mission, state.progress?.current, view, colour, taken);
    for (const { geometry } of items.rally)
      if (geometry?.type === "Point") drawMark(pen, pixel(geometry.coordinates), words.say("chart.rally"), colour, false);
    if (state.home?.place) {
      const at = pixel([state.home.place.lon, state.home.place.lat]);
      drawMark(pen, at, words.say("chart.home"), colour, true);
      taken.push([at[0] - 12, at[1] - 12, at[0] + 12, at[1] + 12]);
    }
    if (draft !== null) taken.push(...draftRoom(draft, pixel));
    const boat = state.place ? { at: plane.to([state.place.lon, state.place.lat]), state } : null;
    const [x, y] = view.toPixel(boat?.at ?? [0, 0]);
    if (boat !== null) taken.push([x - 18, y - 18, x + 18, y + 18]);
    const vessels = Object.values(state.vessels ?? {}).map((one) => ({ one, at: plane.to([one.place.lon, one.place.lat]) }));
    const pixelsOff = ({ at }) => Math.hypot(view.toPixel(at)[0] - x, view.toPixel(at)[1] - y);
    for (const { one, at } of vessels.sort((a, b) => pixelsOff(a) - pixelsOff(b)))
      drawVessel(pen, one, boat, at, view, colour, words, taken);
    if (isCharted) drawNames(pen, map, view, colour, taken);
    if (draft !== null) drawDraft(pen, draft, pixel, colour);
    for (const one of others) drawOther(pen, one, pixel(one.place), view, colour);
    if (state.place) {
      const at = pixel([state.place.lon, state.place.lat]);
      drawSenses(pen, state, at, view, colour);
      drawBoat(pen, state, at, view, colour, isHeard);
    }
    drawScale(pen, view, colour, words);
    drawNorth(pen, colour, words);
    drawCurrent(pen, state.current, colour, words);
    if (canvas.matches(":focus-visible")) drawCross(pen, view, colour);
  }

  return {
    showState(next) {
      const place = next.place ?? null;
      if (place !== null) {
        usePlane([place.lon, place.lat]);
        if (!hasBoat) {
          hasBoat = true;
          view.scale = Math.max(view.scale, FOLLOW_SCALE);
        }
      }
      const now = JSON.stringify(SHOWN.map((key) => next[key] ?? null));
      if (now === shown) return;
      shown = now;
      state = next;
      if (isFollowing && place !== null) {
        const [x, y] = view.toPixel(plane.to([place.lon, place.lat]));
        if (Math.hypot(x - view.width / 2, y - view.height / 2) > STILL_PX) centre();
      }
      changed();
    },
    showChart(next) {
      geojson = next ?? NONE;
      const first = (geojson.features ?? []).find((one) => one.geometry?.type === "Polygon");
      if (plane === null && first) usePlane(first.geometry.coordinates[0][0]);
      else if (plane !== null) map = prepare(geojson, plane);
      if (map?.bounds) view.limit(map.bounds);
      if (map?.bounds && !hasBoat) view.fit(map.bounds);
      changed();
    },
    showItems(kind, list) {
      items[kind] = list?.features ?? [];
      changed();
    },
    showTrack(points) {
      trackPlaces = points ?? [];
      trackMetres();
      changed();
    },
    showWay(points) {
      way = points;
      changed();
    },
    showOthers(next) {
      if (JSON.stringify(next) === JSON.stringify(others)) return;
      others = next;
      changed();
    },
    showHeard(isOn) {
      if (isOn === isHeard) return;
      isHeard = isOn;
      changed();
    },
    follow: () => follow(true),
    // Whether the map says that a place is no water. Without a map nothing is known.
    isAshore: (lat, lon) => plane !== null && map?.bounds != null && !isWater(pen, map, plane.to([lon, lat])),
    // The boat drawn near a place, or null.
    otherAt(lat, lon) {
      if (plane === null) return null;
      const away = (place) => {
        const [at, from] = [place, [lon, lat]].map((one) => view.toPixel(plane.to(one)));
        return Math.hypot(at[0] - from[0], at[1] - from[1]);
      };
      const near = others.filter((one) => away(one.place) <= OTHER_PX).sort((a, b) => away(a.place) - away(b.place));
      return near[0] ?? null;
    },
    // draft: {places, isArea, line} of [lon, lat], or null
    showDraft(next) {
      draft = next;
      changed();
    },
    // Moves and zooms the chart only where some of the points are outside of it.
    lookAt(points) {
      if (plane === null || points.length === 0) return;
      const metres = points.map((point) => plane.to(point));
      const isIn = ([x, y]) => x > 0 && y > 0 && x < view.width && y < view.height;
      if (metres.every((at) => isIn(view.toPixel(at)))) return;
      const away = isFollowing || hasLookedAway;
      follow(false);
      hasLookedAway = away;
      const [easts, norths] = [metres.map(([east]) => east), metres.map(([, north]) => north)];
      view.fit([Math.min(...easts), Math.min(...norths), Math.max(...easts), Math.max(...norths)], LOOK_SHARE);
      changed();
    },
    // Follows the boat again, unless the chart was moved by hand meanwhile.
    lookBack() {
      if (hasLookedAway) follow(true);
    },
    onTap(callback) {
      tapped = callback;
    },
  };
}

function makeTools(canvas, words, on) {
  const box = document.createElement("div");
  box.className = "chart-tools";
  const tools = {};
  const labels = { follow: words.say("chart.follow"), in: words.say("chart.in"), out: words.say("chart.out") };
  for (const [name, sign] of [["follow", "\u25CE"], ["in", "+"], ["out", "\u2212"]]) {
    const button = document.createElement("button");
    button.type = "button";
    button.textContent = sign;
    button.title = labels[name];
    button.setAttribute("aria-label", labels[name]);
    button.addEventListener("click", on[name]);
    box.append(button);
    tools[name] = button;
  }
  tools.follow.setAttribute("aria-pressed", "true");
  canvas.after(box);
  return tools;
}
