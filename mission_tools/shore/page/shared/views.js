// The views of the page. Sail is in index.html; each of the others is a module, fetched when it is first opened.
//
// NAME/NAME.js exports makeView(box, page); NAME/NAME.css is its style. It returns what it wants to hear:
// {showState(snapshot), opened(), closed(), tap(lat, lon)}, all optional. Only the open view is called.
import { element } from "./elements.js";

const VIEWS = ["plan", "logs", "boat"];

// sail: what the first view wants to hear. page: {words, live, go, data, chart}; chart and data are null until loaded.
export function wireViews(place, page, sail) {
  const views = new Map([["sail", sail]]);
  const links = new Map();
  let open = "sail";
  let shown = null; // the latest snapshot

  const heard = (name) => views.get(open)?.[name] ?? (() => {});

  function show(name) {
    if (name === open) return;
    heard("closed")();
    open = name;
    place.main.dataset.view = name;
    for (const [other, link] of links) link.setAttribute("aria-current", other === name ? "page" : "false");
    for (const box of place.boxes.values()) box.hidden = box.id !== name;
    if (views.has(name)) enter();
    else load(name);
  }

  function enter() {
    heard("opened")();
    if (shown !== null) heard("showState")(shown);
  }

  async function load(name) {
    const box = place.boxes.get(name);
    box.textContent = page.words.say("views.loading");
    try {
      await styled(`${name}/${name}.css`);
      const { makeView } = await import(`../${name}/${name}.js`);
      if (views.has(name)) return;
      box.replaceChildren();
      views.set(name, makeView(box, page));
    } catch (error) {
      console.warn(error);
      box.textContent = page.words.say("views.lost");
      return;
    }
    if (open === name) enter();
  }

  place.nav.hidden = VIEWS.length === 0;
  place.boxes = new Map();
  for (const name of ["sail", ...VIEWS]) {
    const title = page.words.say(`views.${name}`);
    const link = element("a", { href: `#${name}`, text: title, "aria-current": name === "sail" ? "page" : "false" });
    links.set(name, link);
    place.nav.append(link);
    if (name === "sail") continue;
    const box = element("section", { id: name, className: "view", hidden: true, "aria-label": title });
    place.boxes.set(name, box);
    place.main.append(box);
  }
  const follow = () => {
    const name = location.hash.slice(1);
    show(links.has(name) ? name : "sail");
  };
  addEventListener("hashchange", follow);
  follow();

  return {
    showState(snapshot) {
      shown = snapshot;
      heard("showState")(snapshot);
    },
    tap: (lat, lon) => heard("tap")(lat, lon),
  };
}

function styled(address) {
  return new Promise((resolve, reject) => {
    const link = element("link", { rel: "stylesheet", href: address });
    link.onload = resolve;
    link.onerror = () => {
      link.remove(); // the next try fetches it anew
      reject(new Error(address));
    };
    document.head.append(link);
  });
}
