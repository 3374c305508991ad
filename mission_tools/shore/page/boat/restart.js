// Boat, restart: the boat's program begins anew, which takes its configuration; then the boat is heard again.
import { element, heldButton } from "../shared/elements.js";
import { holdButton } from "../shared/hold.js";

const LONGEST_S = 60;
const now_s = () => performance.now() / 1000;

export const title = "restart.title";

export function makePanel(inside, page) {
  const { say } = page.words;
  const name = say("restart.title");
  const press = heldButton("i-arm", name);
  const sentence = element("p", { className: "restart-sentence", role: "status" });
  const news = element("p", { className: "restart-news", role: "status" });
  inside.append(element("div", { className: "restart" }, element("p", { text: say("restart.what") }), sentence, press, news));
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
    setTimeout(() => asked === own && end("restart.lost"), LONGEST_S * 1000);
    show();
    news.textContent = say("restart.asked");
    const answer = await page.go.ask("restart", {}, name);
    if (answer.ok === false) {
      asked = null;
      news.textContent = "";
      show();
    }
  }
  holdButton(press, act, name, page.words, page.go.tell);

  const show = () => (press.disabled = !isAllowed || asked !== null);
  return {
    showState(state) {
      const isArmed = state.armed === true;
      isAllowed = page.live.isSkipper && !isArmed;
      sentence.textContent = !page.live.isSkipper ? say("restart.viewer") : isArmed ? say("restart.armed") : "";
      sentence.hidden = sentence.textContent === "";
      starts = state.starts ?? starts;
      if (asked !== null && starts !== asked.starts) end("restart.back");
      show();
    },
  };
}
