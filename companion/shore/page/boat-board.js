// Boat, board: what is set up on the boat's own computer. It needs the PIN, and every boat disarmed.
import { askBoard } from "./boat-board-ask.js";
import { makeConfig } from "./boat-board-config.js";
import { makeRestart } from "./boat-board-restart.js";
import { makeUpdate } from "./boat-board-update.js";
import { makeWifi } from "./boat-board-wifi.js";
import { element } from "./elements.js";

export const title = "board.title";

// what: the name in GET /api/board, true where this part works; null: everywhere.
const PARTS = [
  ["config", makeConfig],
  [null, makeRestart],
  [null, makeUpdate],
  ["wifi", makeWifi],
];

export function makePanel(inside, page) {
  const { say } = page.words;
  const sentence = element("p", { className: "board-sentence", role: "status" });
  const box = element("div", { className: "board" });
  inside.append(sentence, box);
  let parts = null; // built once the server has said what works here
  let isAsking = false;
  let isOpen = false;
  let state = null;

  async function build() {
    if (parts !== null || isAsking || !page.live.isSkipper) return;
    isAsking = true;
    const { ok, text, body } = await askBoard(page.words, "");
    isAsking = false;
    if (!ok) {
      sentence.textContent = text ?? say("board.lost");
      return;
    }
    const works = PARTS.filter(([what]) => what === null || body[what]);
    parts = works.map(([, make]) => make(box, page, body));
    if (works.every(([what]) => what === null)) box.prepend(element("p", { text: say("board.elsewhere") }));
    show();
    if (isOpen) for (const part of parts) part.opened?.();
  }

  function show() {
    const isArmed = state?.armed === true;
    sentence.textContent = !page.live.isSkipper ? say("board.viewer") : isArmed ? say("board.armed") : "";
    sentence.hidden = sentence.textContent === "";
    box.hidden = !page.live.isSkipper;
    for (const part of parts ?? []) part.show({ state, isAllowed: page.live.isSkipper && !isArmed });
  }

  return {
    opened() {
      isOpen = true;
      build();
      for (const part of parts ?? []) part.opened?.();
    },
    closed() {
      isOpen = false;
      for (const part of parts ?? []) part.closed?.();
    },
    showState(snapshot) {
      state = snapshot;
      build();
      show();
    },
  };
}
