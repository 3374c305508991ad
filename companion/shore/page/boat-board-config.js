// The boat's configuration: its text, what the boat's program says of it, and the earlier ones.
import { askBoard, postBoard } from "./boat-board-ask.js";
import { button, element } from "./elements.js";

export function makeConfig(box, page) {
  const { say } = page.words;
  const { tell } = page.go;
  const name = element("p", { className: "board-note" });
  const area = element("textarea", {
    id: "board-config", rows: 16, wrap: "off", spellcheck: "false", autocapitalize: "off", autocomplete: "off",
    on: { keyup: () => showLine(), click: () => showLine(), input: () => changed() },
  });
  const line = element("p", { className: "board-note" });
  const complaints = element("ul", { className: "board-complaints", "aria-label": say("board.complaints") });
  const check = button(say("board.check"), () => send("/config/check", "board.check"));
  const save = button(say("board.save"), () => send("/config", "board.save"), { className: "strong" });
  const again = button(say("board.read"), () => read());
  const earlier = element("select", { id: "board-earlier" });
  const load = button(say("board.earlier.show"), () => read(Number(earlier.value)));
  const earlierLabel = element("label", { for: "board-earlier", text: say("board.earlier") });
  const back = element("div", { className: "board-row" }, earlier, load);
  box.append(
    element(
      "section",
      { "aria-labelledby": "board-config-title" },
      element("h3", { id: "board-config-title", text: say("board.config") }),
      name,
      element("label", { for: "board-config", text: say("board.config.text") }),
      area,
      line,
      complaints,
      element("div", { className: "board-row" }, check, save, again),
      earlierLabel,
      back,
    ),
  );
  let hash = null; // of the text on the boat
  let saved = "";
  let isBusy = false;
  let isAllowed = false;

  const showButtons = () => {
    const canSend = isAllowed && !isBusy && hash !== null;
    check.disabled = save.disabled = !canSend;
    again.disabled = load.disabled = isBusy;
  };

  function showLine() {
    const number = area.value.slice(0, area.selectionStart).split("\n").length;
    line.textContent = say(area.value === saved ? "board.line" : "board.line.changed", { n: number });
  }

  function changed() {
    complaints.replaceChildren();
    showLine();
  }

  async function read(number = 0) {
    isBusy = true;
    showButtons();
    const { ok, text, body } = await askBoard(page.words, number ? `/config/${number}` : "/config");
    isBusy = false;
    if (ok) {
      area.value = body.config.text;
      complaints.replaceChildren();
      name.textContent = body.name;
      showEarlier(body.kept);
      if (number) {
        tell(say("board.earlier.shown"));
      } else {
        hash = body.config.hash;
        saved = area.value;
      }
      area.setSelectionRange(0, 0);
      showLine();
    } else tell(text ?? say("board.lost"), false);
    showButtons();
  }

  function showEarlier(kept) {
    const options = kept.map((one) => new Option(page.words.date(one.time_s), one.number));
    earlier.replaceChildren(...options);
    earlierLabel.hidden = back.hidden = options.length === 0;
  }

  async function send(path, key) {
    isBusy = true;
    showButtons();
    tell(say("board.checking"));
    complaints.replaceChildren();
    const text = area.value;
    const answer = await postBoard(page.words, path, { text, replaced: hash });
    isBusy = false;
    if (!answer.ok) tell(say("go.answer", { name: say(key), text: answer.text ?? say("board.lost") }), false);
    else if (!answer.body.ok) complain(answer.body.complaints);
    else if (answer.body.hash === undefined) tell(say("board.fine"), true);
    else {
      hash = answer.body.hash;
      saved = text;
      tell(say("board.saved"), true);
      refresh();
      showLine();
    }
    showButtons();
  }

  // The list of the earlier ones, with the text as it is.
  async function refresh() {
    const { ok, body } = await askBoard(page.words, "/config");
    if (ok) showEarlier(body.kept);
  }

  function complain(found) {
    tell(say("board.wrong"), false);
    complaints.replaceChildren(
      ...found.map((one) =>
        element(
          "li",
          {},
          element("span", { text: one.line === null ? one.text : say("board.complaint", { line: one.line, text: one.text }) }),
          one.line === null ? null : button(say("board.go_to", { line: one.line }), () => goTo(one.line)),
        ),
      ),
    );
  }

  function goTo(number) {
    const lines = area.value.split("\n");
    const from = lines.slice(0, number - 1).join("\n").length + (number > 1 ? 1 : 0);
    area.focus();
    area.setSelectionRange(from, from + (lines[number - 1] ?? "").length);
    const height = parseFloat(getComputedStyle(area).lineHeight);
    area.scrollTop = Math.max(0, (number - 3) * height);
    area.scrollLeft = 0;
    showLine();
  }

  return {
    opened() {
      if (hash === null || area.value === saved) read();
    },
    show(now) {
      isAllowed = now.isAllowed;
      showButtons();
    },
  };
}
