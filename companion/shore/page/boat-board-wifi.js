// The boat's Wi-Fi. A change is kept when this page asks again afterwards, which it does while the panel is open.
import { askBoard, postBoard } from "./boat-board-ask.js";
import { button, element } from "./elements.js";

const LOOK_MS = 10_000;
const CHANGING_MS = 2_000;
const STAGES = {
  changing: "board.wifi.changing",
  unconfirmed: "board.wifi.unconfirmed",
  kept: "board.wifi.kept",
  failed: "board.wifi.failed",
  back: "board.wifi.back",
};

export function makeWifi(box, page) {
  const { words, go } = page;
  const { say } = words;
  const now = element("p");
  const news = element("p", { className: "board-news", role: "status" });
  const networks = element("ul", { className: "board-list", "aria-label": say("board.wifi.networks") });
  const saved = element("ul", { className: "board-list", "aria-label": say("board.wifi.saved") });
  const password = element("input", { id: "board-wifi-password", type: "password", autocomplete: "off", maxlength: 63 });
  const passwordLabel = element("label", { for: "board-wifi-password" });
  const joinIt = element("button", { type: "submit", className: "strong", text: say("board.wifi.join") });
  const form = element("form", { className: "board-form", hidden: true, on: { submit: (event) => join(event) } }, passwordLabel, password, joinIt);
  const own = element("input", { id: "board-hotspot", type: "password", autocomplete: "new-password", maxlength: 63 });
  const on = button(say("board.wifi.hotspot_on"), () => change("/wifi/hotspot", { on: true, password: own.value }));
  const off = button(say("board.wifi.hotspot_off"), () => change("/wifi/hotspot", { on: false }));
  const look = button(say("board.wifi.look"), () => show(true));
  box.append(
    element(
      "section",
      { "aria-labelledby": "board-wifi-title" },
      element("h3", { id: "board-wifi-title", text: say("board.wifi") }),
      now,
      news,
      element("p", { className: "board-note", text: say("board.wifi.careful") }),
      element("h4", { text: say("board.wifi.networks") }),
      networks,
      form,
      look,
      element("h4", { text: say("board.wifi.saved") }),
      saved,
      element("h4", { text: say("board.wifi.hotspot") }),
      element("label", { for: "board-hotspot", text: say("board.wifi.hotspot_password") }),
      own,
      element("div", { className: "board-row" }, on, off),
    ),
  );
  let state = null;
  let chosen = null; // the network to join
  let isAllowed = false;
  let isOpen = false;
  let timer = null;
  let drawn = "";

  const isChanging = () => ["changing", "unconfirmed"].includes(state?.change.stage);
  const nameOf = (name) => name || say("board.wifi.another");

  async function show(isAsked = false) {
    clearTimeout(timer);
    if (isAsked) go.tell(say("board.wifi.looking"));
    const answer = await askBoard(words, "/wifi");
    if (answer.ok) {
      state = answer.body;
      draw();
      if (isAsked) go.tell("");
    } else if (isAsked || state === null) go.tell(answer.text ?? say("board.lost"), false);
    clearTimeout(timer);
    if (isOpen) timer = setTimeout(show, isChanging() ? CHANGING_MS : LOOK_MS);
  }

  function draw() {
    const { stage, name, why } = state.change;
    const used = state.networks.find((one) => one.is_used);
    now.textContent = !state.device
      ? say("board.wifi.no_device")
      : !state.address
        ? say("board.wifi.not_now")
        : state.is_hotspot
          ? say("board.wifi.hotspot_now", { address: state.address })
          : say("board.wifi.now", { name: used?.name ?? "–", address: state.address });
    news.textContent = stage === "idle" ? "" : say(STAGES[stage], { name: nameOf(name), text: words.told(why) });
    news.dataset.level = stage === "kept" ? "good" : stage === "failed" || stage === "back" ? "bad" : "";
    const key = JSON.stringify([state.networks, state.saved, state.is_hotspot]);
    if (key !== drawn) {
      drawn = key;
      networks.replaceChildren(...(state.networks.length ? state.networks.map(network) : [element("li", { text: say("board.wifi.empty") })]));
      saved.replaceChildren(...state.saved.filter((one) => one.name !== "mavboat-hotspot").map(known));
    }
    showButtons();
  }

  function network(one) {
    const security = one.security === "open" ? say("board.wifi.open") : one.security === "other" ? say("board.wifi.cannot") : one.security;
    const text = say("board.wifi.network", { name: one.name, signal: words.percent(one.signal / 100), security });
    const act = one.is_used
      ? element("strong", { text: `✓ ${say("board.wifi.used")}` })
      : one.security === "other"
        ? null
        : button(say("board.wifi.join"), () => choose(one), { "aria-label": say("board.wifi.join_it", { name: one.name }) });
    return element("li", {}, element("span", { text }), act);
  }

  function known(one) {
    const use = button(say("board.wifi.use"), () => change("/wifi/use", { uuid: one.uuid }), { "aria-label": say("board.wifi.use_it", { name: one.name }) });
    const forget = button(say("board.wifi.forget"), () => drop(one), { "aria-label": say("board.wifi.forget_it", { name: one.name }) });
    const acts = one.is_active ? [element("strong", { text: `✓ ${say("board.wifi.used")}` })] : [use, forget];
    return element("li", {}, element("span", { text: one.name }), ...acts);
  }

  function choose(one) {
    chosen = one;
    passwordLabel.textContent = say(one.security === "open" ? "board.wifi.join_it" : "board.wifi.password", { name: one.name });
    password.hidden = one.security === "open";
    form.hidden = false;
    (password.hidden ? joinIt : password).focus();
  }

  async function join(event) {
    event.preventDefault();
    const { name, security } = chosen;
    if (await change("/wifi/join", { name, security, password: password.value })) {
      password.value = "";
      form.hidden = true;
    }
  }

  async function change(path, content) {
    const answer = await postBoard(words, path, content);
    if (answer.ok) {
      own.value = "";
      state = { ...state, change: answer.body };
      go.tell(say("board.wifi.changing", { name: nameOf(answer.body.name) }));
      draw();
    } else go.tell(answer.text ?? say("board.lost"), false);
    clearTimeout(timer);
    timer = setTimeout(show, CHANGING_MS);
    return answer.ok;
  }

  async function drop(one) {
    const answer = await postBoard(words, "/wifi/forget", { uuid: one.uuid });
    if (answer.ok) go.tell(say("board.wifi.forgotten", { name: one.name }), true);
    else go.tell(answer.text ?? say("board.lost"), false);
    show();
  }

  function showButtons() {
    const can = isAllowed && state !== null && state.device !== "" && !isChanging();
    for (const one of [...networks.querySelectorAll("button"), ...saved.querySelectorAll("button"), joinIt, on]) one.disabled = !can;
    off.disabled = !can || !state.is_hotspot;
  }

  showButtons();
  return {
    opened() {
      isOpen = true;
      show();
    },
    closed() {
      isOpen = false;
      clearTimeout(timer);
    },
    show(given) {
      isAllowed = given.isAllowed;
      showButtons();
    },
  };
}
