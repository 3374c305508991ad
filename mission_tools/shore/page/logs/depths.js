// The depth chart of a log: its picture, figures, and files.
import { button, element, pair } from "../shared/elements.js";

const FILES = ["/depth.tif", "/chart.gpkg", "/gaps.geojson", "/lake.geojson"];

// figures: chart.json; address: of the chart's files. back(): to the list.
export function makeDepths(name, figures, address, words, back) {
  const title = words.say("depths.of", { name });
  const said = (key, value, digits) => (value === null ? "–" : words.say(key, { n: words.number(value, digits) }));
  const link = (file, text, options) => element("a", { className: "button", href: address + file, text, ...options });
  return element(
    "article",
    { className: "voyage", "aria-label": title },
    element("div", { className: "head" }, button(words.say("logs.back"), back), link("/chart.html", words.say("depths.open"), { target: "_blank", rel: "noopener" })),
    element("h2", { text: title, tabindex: -1 }),
    element("dl", {},
      pair(words.say("depths.deepest"), said("unit.m", figures.max_depth_m, 2)),
      pair(words.say("depths.mean"), said("unit.m", figures.mean_depth_m, 2)),
      pair(words.say("depths.band"), said("depths.plus_minus", figures.band_median_m, 2)),
      pair(words.say("depths.volume"), said("depths.m3", figures.volume_m3, 0)),
      pair(words.say("depths.coverage"), figures.coverage === null ? "–" : words.percent(figures.coverage)),
    ),
    element("img", { src: `${address}/chart.png`, alt: words.say("depths.picture") }),
    element("nav", { className: "files", "aria-label": words.say("depths.files") }, ...FILES.map((file) => link(file, file.slice(1), { download: "" }))),
  );
}
