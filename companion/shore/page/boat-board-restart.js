// Restart: the boat's program begins anew, which takes the configuration; then the boat is heard again.
import { element, heldButton } from "./elements.js";
import { holdButton } from "./hold-button.js";

const LONGEST_S = 60;
const now_s = () => performance.now() / 1000;

export function makeRestart(box, page) {
  const { say } = page.words;
  const name = say("board.restart");
  const press = heldButton("i-arm", name);
  const news = element("p", { className: "board-note", role: "status" });
  box.append(
    element(
      "section",
      { "aria-labelledby": "board-restart-title" },
      element("h3", { id: "board-restart-title", text: name }),
      element("p", { text: say("board.restart.what") }),
      press,
      news,
    ),
  );
  let isAllowed = false;
  let starts = 0; // as last heard
  let asked = null; // {starts, at}: since when it is waited for

  const end = (key) => {
    news.textContent = say(key, { time: page.words.duration(now_s() - asked.at) });
    asked = null;
    show();
  };

  async function act() {
    const own = { starts, at: now_s() };
    asked = own;
    setTimeout(() => asked === own && end("board.restart.lost"), LONGEST_S * 1000);
    show();
    news.textContent = say("board.restart.asked");
    const answer = await page.go.ask("restart", {}, name);
    if (answer.ok === false) {
      asked = null;
      news.textContent = "";
      show();
    }
  }
  holdButton(press, act, (isByReader) => page.go.tell(say(isByReader ? "go.again" : "go.longer", { name })));

  const show = () => (press.disabled = !isAllowed || asked !== null);
  return {
    show(now) {
      isAllowed = now.isAllowed;
      starts = now.state?.starts ?? starts;
      if (asked !== null && starts !== asked.starts) end("board.restart.back");
      show();
    },
  };
}
