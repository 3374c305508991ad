// Fingers, mouse, wheel and keys on the chart: pan, zoom, tap. Positions are in pixels of the canvas.

const TAP_PX = 8;
const TAP_MS = 700;
const WHEEL = 0.0015; // share of zoom a pixel of the wheel
const KEY_PX = 60;
const KEY_ZOOM = 1.4;

const ARROWS = { ArrowLeft: [KEY_PX, 0], ArrowRight: [-KEY_PX, 0], ArrowUp: [0, KEY_PX], ArrowDown: [0, -KEY_PX] };

// on: {pan(dx, dy, isPinch), zoom(factor, at), tap(at), follow(), middle() -> at}
export function listen(canvas, on) {
  const fingers = new Map();
  let press = null; // {at, time_ms} while it may become a tap

  const at = (event) => {
    const box = canvas.getBoundingClientRect();
    return [event.clientX - box.left - canvas.clientLeft, event.clientY - box.top - canvas.clientTop];
  };
  const apart = (a, b) => Math.hypot(a[0] - b[0], a[1] - b[1]);

  canvas.addEventListener("pointerdown", (event) => {
    if (event.pointerType === "mouse" && event.button !== 0) return;
    canvas.setPointerCapture(event.pointerId);
    fingers.set(event.pointerId, at(event));
    press = fingers.size === 1 ? { at: at(event), time_ms: event.timeStamp } : null;
  });

  canvas.addEventListener("pointermove", (event) => {
    const before = fingers.get(event.pointerId);
    if (before === undefined) return;
    const now = at(event);
    if (press !== null && apart(press.at, now) <= TAP_PX) return; // a still finger trembles
    press = null;
    const others = [...fingers].filter(([id]) => id !== event.pointerId).map(([, place]) => place);
    if (others.length === 0) {
      on.pan(now[0] - before[0], now[1] - before[1], false);
    } else {
      const still = others[0];
      on.pan((now[0] - before[0]) / 2, (now[1] - before[1]) / 2, true);
      if (apart(still, before) > 4 && apart(still, now) > 4)
        on.zoom(apart(still, now) / apart(still, before), [(still[0] + now[0]) / 2, (still[1] + now[1]) / 2]);
    }
    fingers.set(event.pointerId, now);
  });

  canvas.addEventListener("pointerup", (event) => {
    fingers.delete(event.pointerId);
    if (press !== null && event.timeStamp - press.time_ms <= TAP_MS) on.tap(press.at);
    press = null;
  });
  for (const name of ["pointercancel", "lostpointercapture"])
    canvas.addEventListener(name, (event) => {
      fingers.delete(event.pointerId);
      press = null;
    });

  canvas.addEventListener(
    "wheel",
    (event) => {
      event.preventDefault();
      const pixels = event.deltaY * (event.deltaMode === 0 ? 1 : event.deltaMode === 1 ? 20 : 400);
      on.zoom(Math.exp(-WHEEL * Math.max(-400, Math.min(400, pixels))), at(event));
    },
    { passive: false },
  );

  canvas.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.altKey || event.metaKey) return;
    if (event.key in ARROWS) on.pan(...ARROWS[event.key], false);
    else if (event.key === "+" || event.key === "=") on.zoom(KEY_ZOOM, on.middle());
    else if (event.key === "-" || event.key === "_") on.zoom(1 / KEY_ZOOM, on.middle());
    else if (event.key === "0") on.follow();
    else if (event.key === "Enter" && !event.repeat) on.tap(on.middle());
    else return;
    event.preventDefault();
  });
}
