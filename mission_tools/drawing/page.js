"use strict";
(() => {
  const map = document.getElementById("map"), mark = document.getElementById("mark");
  const whole = JSON.parse(map.dataset.view);
  const placed = [...map.querySelectorAll("[data-at]")].map(g => ({
    g, at: g.dataset.at.split(",").map(Number), kind: g.classList[0], metres: Number(g.dataset.metres || 0), off: (g.dataset.off || "0,0").split(",").map(Number),
    text: g.querySelector("text").textContent }));
  // What matters most takes its room first: ends of the route, numbers, names, lengths
  const rank = p => p.kind === "pin" ? (p.g.classList.contains("start") || p.g.classList.contains("goal") ? 0 : 1)
    : p.kind === "name" ? 3 : 2;
  placed.sort((a, b) => rank(a) - rank(b));
  const isCrowded = placed.filter(p => p.kind === "pin").length > 60;
  map.classList.toggle("crowded", isCrowded);
  let view = whole.slice();

  function draw() {
    const box = map.getBoundingClientRect();
    const scale = Math.max(view[2] / box.width, view[3] / box.height); // metres a pixel
    map.setAttribute("viewBox", view.join(" "));
    const taken = [];
    for (const p of placed) {
      const isPin = p.kind === "pin";
      const apart = isPin && isCrowded && rank(p) > 0 ? 26 : 10; // a survey's numbers stand far apart
      const half = isPin ? [apart, apart] : [p.text.length * 3.4 + 2, 8];
      const away = half[0] * Math.abs(p.off[0]) + 11;
      const x = p.at[0] / scale + away * p.off[0], y = p.at[1] / scale + away * p.off[1];
      const own = [x - half[0], y - half[1], x + half[0], y + half[1]];
      const hits = taken.some(t => own[0] < t[2] && own[2] > t[0] && own[1] < t[3] && own[3] > t[1]);
      const isShort = p.kind === "length" && p.metres / scale < 2 * half[0] + 26;
      p.g.setAttribute("transform", `translate(${x * scale} ${y * scale}) scale(${scale})`);
      p.g.classList.toggle("covered", !isPin && (hits || isShort));
      p.g.classList.toggle("small", isPin && hits && rank(p) > 0);
      if (!hits && !isShort) taken.push(isPin ? [x - 10, y - 10, x + 10, y + 10] : own);
    }
    for (const p of placed.slice().reverse()) if (p.kind === "pin") map.append(p.g);
    map.append(mark);
    mark.setAttribute("r", 12 * scale);
    const most = 110 * scale, power = 10 ** Math.floor(Math.log10(most));
    const length = [5, 2, 1].map(n => n * power).find(n => n <= most);
    document.getElementById("bar").style.width = `${length / scale}px`;
    document.getElementById("bar-text").textContent = length >= 1000 ? `${length / 1000} km` : `${length} m`;
  }

  function zoom(by, x, y) {
    const box = map.getBoundingClientRect();
    const scale = Math.max(view[2] / box.width, view[3] / box.height);
    const width = view[2] * by;
    if (width < 2 || width > 40 * whole[2]) return;
    const at = [view[0] + view[2] / 2 + (x - box.left - box.width / 2) * scale,
      view[1] + view[3] / 2 + (y - box.top - box.height / 2) * scale];
    view = [at[0] + (view[0] - at[0]) * by, at[1] + (view[1] - at[1]) * by, width, view[3] * by];
    draw();
  }

  function middleZoom(by) {
    const box = map.getBoundingClientRect();
    zoom(by, box.left + box.width / 2, box.top + box.height / 2);
  }

  function show(element) {
    view = element.dataset.box.split(",").map(Number);
    const at = element.dataset.mark;
    mark.style.display = at ? "" : "none";
    if (at) { const [x, y] = at.split(","); mark.setAttribute("cx", x); mark.setAttribute("cy", y); }
    for (const p of placed) p.g.classList.toggle("lit", p.kind === "pin" && p.g.dataset.n === element.dataset.n);
    draw();
    map.scrollIntoView({ block: "nearest", behavior: "smooth" });
  }

  const fingers = new Map();
  map.addEventListener("pointerdown", e => { fingers.set(e.pointerId, [e.clientX, e.clientY]); map.setPointerCapture(e.pointerId); });
  map.addEventListener("pointermove", e => {
    const before = fingers.get(e.pointerId);
    if (!before) return;
    const now = [e.clientX, e.clientY];
    if (fingers.size === 2) {
      const [a, b] = [...fingers].filter(([id]) => id !== e.pointerId).concat([[0, before]]).map(([, at]) => at);
      const apart = (p, q) => Math.hypot(p[0] - q[0], p[1] - q[1]);
      if (apart(a, now) > 1) zoom(apart(a, b) / apart(a, now), (a[0] + now[0]) / 2, (a[1] + now[1]) / 2);
    } else {
      const box = map.getBoundingClientRect();
      const scale = Math.max(view[2] / box.width, view[3] / box.height);
      view[0] -= (now[0] - before[0]) * scale;
      view[1] -= (now[1] - before[1]) * scale;
      draw();
    }
    fingers.set(e.pointerId, now);
  });
  for (const end of ["pointerup", "pointercancel"]) map.addEventListener(end, e => fingers.delete(e.pointerId));
  map.addEventListener("wheel", e => { e.preventDefault(); zoom(e.deltaY > 0 ? 1.2 : 1 / 1.2, e.clientX, e.clientY); }, { passive: false });
  map.addEventListener("dblclick", e => zoom(0.5, e.clientX, e.clientY));
  document.getElementById("in").onclick = () => middleZoom(1 / 1.6);
  document.getElementById("out").onclick = () => middleZoom(1.6);
  document.getElementById("fit").onclick = () => { view = whole.slice(); draw(); };
  for (const e of document.querySelectorAll("[data-box]")) {
    e.addEventListener("click", () => show(e));
    if (e.tagName === "TR") e.addEventListener("keydown", key => { if (key.key === "Enter") show(e); });
  }
  document.getElementById("theme").onclick = () => {
    const root = document.documentElement, isDark = matchMedia("(prefers-color-scheme: dark)").matches;
    const now = root.dataset.theme || (isDark ? "dark" : "light");
    root.dataset.theme = now === "dark" ? "light" : "dark";
  };
  addEventListener("resize", draw);
  mark.style.display = "none";
  draw();
})();
