// Update: a wheel file is uploaded, shown with its version, and installed while a button is held. Page and boat restart.
import { askBoard } from "./boat-board-ask.js";
import { button, element, heldButton } from "./elements.js";
import { holdButton } from "./hold-button.js";

const LOOK_MS = 10_000;
const RUNNING_MS = 2_000;
const MOST_BYTES = 30_000_000; // as the server's
const LONGEST_MS = 360_000; // the server ends an upload after 5 minutes
const RESULTS = { done: "board.update.done", "went back": "board.update.went_back", refused: "board.update.refused" };

export function makeUpdate(box, page, works) {
  const { words, go, live } = page;
  const { say } = words;
  const section = element(
    "section",
    { "aria-labelledby": "board-update-title" },
    element("h3", { id: "board-update-title", text: say("board.update") }),
  );
  const reload = element(
    "div",
    { className: "board-form", hidden: true },
    element("p", { role: "status", text: "" }),
    button(say("board.update.reload_it"), () => location.reload(), { className: "strong" }),
  );
  const showReload = () => {
    const isOld = live.hello !== null && live.hello.version !== live.version;
    reload.hidden = !isOld;
    const text = isOld ? say("board.update.reload", { version: live.hello.version }) : "";
    if (reload.firstChild.textContent !== text) reload.firstChild.textContent = text;
  };
  box.append(section);
  if (!works.update) {
    section.append(element("p", { text: say("board.update.off") }), reload);
    return { show: showReload };
  }

  const present = element("p");
  const news = element("p", { className: "board-news", role: "status" });
  const file = element("input", { id: "board-update-file", type: "file", accept: ".whl", on: { change: () => upload() } });
  const share = element("progress", { max: 1, value: 0, "aria-label": say("board.update.progress") });
  const shareText = element("span");
  const progress = element("p", { className: "board-progress", hidden: true }, share, shareText);
  const waits = element("p", { className: "board-news" });
  const name = say("board.update.install");
  const install = heldButton("i-arm", name);
  const drop = button(say("board.update.drop"), () => discard());
  section.append(
    present,
    news,
    reload,
    element("label", { for: "board-update-file", text: say("board.update.file") }),
    file,
    progress,
    waits,
    install,
    drop,
    element("p", { className: "board-note", text: say("board.update.what") }),
  );
  let state = null;
  let asked = null; // the result before, as text, while this page waits for the next one
  let isUploading = false;
  let isAllowed = false;
  let isOpen = false;
  let timer = null;

  const isRunning = () => asked !== null || (state !== null && state.is_running);

  async function look() {
    clearTimeout(timer);
    const answer = await askBoard(words, "/update", { signal: AbortSignal.timeout?.(8_000) });
    if (answer.ok) take(answer.body);
    else if (isRunning()) announce(say("board.update.restarts"));
    else if (state === null) go.tell(answer.text ?? say("board.lost"), false);
    clearTimeout(timer);
    if (isOpen || asked !== null) timer = setTimeout(look, isRunning() ? RUNNING_MS : LOOK_MS);
  }

  function take(given) {
    state = given;
    if (asked !== null && !state.is_running && JSON.stringify(state.result) !== asked) asked = null;
    draw();
  }

  const announce = (text, level = "") => {
    if (news.textContent !== text) news.textContent = text;
    news.dataset.level = level;
  };

  function draw() {
    const { waiting, result, trouble } = state;
    present.textContent = say("board.update.present", { version: state.present });
    const version = waiting?.version ?? result?.version ?? "";
    if (isRunning()) announce(say("board.update.running", { version }));
    else if (trouble) announce(words.told(trouble), "bad");
    else if (result && RESULTS[result.state]) announce(say(RESULTS[result.state], { version: result.version, before: result.before, text: result.text }), result.state === "done" ? "good" : "bad");
    else announce("");
    waits.hidden = waiting === null || isRunning();
    const key = version === state.present ? "board.update.same" : "board.update.replaces";
    waits.textContent = waits.hidden ? "" : say(key, { version, present: state.present });
    showButtons();
  }

  function showButtons() {
    const can = isAllowed && state !== null && !isUploading;
    file.disabled = !can || isRunning();
    install.hidden = drop.hidden = state === null || state.waiting === null;
    install.disabled = !can || isRunning();
    drop.disabled = !can;
    progress.hidden = !isUploading;
  }

  async function upload() {
    const [chosen] = file.files;
    file.value = "";
    if (chosen === undefined) return;
    if (chosen.size > MOST_BYTES) {
      go.tell(say("board.update.large", { n: MOST_BYTES / 1e6 }), false);
      return;
    }
    isUploading = true;
    showShare(0);
    showButtons();
    go.tell(say("board.update.uploading", { name: chosen.name }));
    const { ok, text, body } = await send(chosen);
    isUploading = false;
    if (ok) go.tell(say(body.version === body.present ? "board.update.same" : "board.update.replaces", body), true);
    else go.tell(text || say("board.lost"), false);
    showButtons();
    await look();
    if (ok && !install.disabled) install.focus();
  }

  function showShare(done) {
    share.value = done;
    shareText.textContent = done < 1 ? words.percent(done) : say("board.update.checking");
  }

  // By XMLHttpRequest: fetch does not tell how much was sent.
  const send = (chosen) =>
    new Promise((resolve) => {
      const request = new XMLHttpRequest();
      const lost = () => resolve({ ok: false, text: null, body: null });
      request.open("POST", `/api/board/update?name=${encodeURIComponent(chosen.name)}`);
      request.timeout = LONGEST_MS;
      request.responseType = "json";
      request.upload.onprogress = ({ loaded, total }) => showShare(total > 0 ? loaded / total : 0);
      request.onload = () => {
        const body = request.response;
        if (body === null) lost();
        else resolve({ ok: request.status === 200, text: words.refusal(body), body });
      };
      request.onerror = request.onabort = request.ontimeout = lost;
      request.send(chosen);
    });

  async function act() {
    asked = JSON.stringify(state.result);
    draw();
    const answer = await askBoard(words, "/update/install", { method: "POST" });
    if (answer.ok) take(answer.body);
    else {
      if (answer.text !== null) asked = null; // else it may have begun
      go.tell(answer.text ?? say("board.update.restarts"), false);
      draw();
    }
    clearTimeout(timer);
    timer = setTimeout(look, RUNNING_MS);
  }
  holdButton(install, act, (isByReader) => go.tell(say(isByReader ? "go.again" : "go.longer", { name })));

  async function discard() {
    const answer = await askBoard(words, "/update", { method: "DELETE" });
    if (answer.ok) {
      asked = null;
      go.tell(say("board.update.dropped"), true);
      take(answer.body);
    } else go.tell(answer.text ?? say("board.lost"), false);
  }

  showButtons();
  return {
    opened() {
      isOpen = true;
      look();
    },
    closed() {
      isOpen = false;
      if (asked === null) clearTimeout(timer);
    },
    show(given) {
      isAllowed = given.isAllowed;
      showReload();
      showButtons();
    },
  };
}
