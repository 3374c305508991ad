// Buttons that are pressed for a while, by finger, mouse or keyboard.

const PRESS_MS = 600; // as long as the ring's transition in style.css
const CONFIRM_MS = 5_000;
const AFTER_MS = 1_500; // a click so long after a press is a screen reader's, which cannot press for long

export const isOff = (button) => button.disabled || button.closest("fieldset:disabled") !== null;

// start(event): pressed; end(): let go, by one of the events `ends`; click(): by a screen reader.
export function onPress(button, ends, { start, end, click }) {
  let pressedMs = -Infinity;
  const begin = (event) => {
    pressedMs = performance.now();
    start(event);
  };
  const finish = () => {
    pressedMs = performance.now();
    end();
  };
  button.addEventListener("pointerdown", (event) => event.button === 0 && begin(event));
  for (const name of ends) button.addEventListener(name, end);
  button.addEventListener("contextmenu", (event) => event.preventDefault());
  for (const [name, act] of [["keydown", begin], ["keyup", finish]])
    button.addEventListener(name, (event) => {
      if (event.key !== " " && event.key !== "Enter") return;
      event.preventDefault();
      if (!event.repeat) act(event);
    });
  button.addEventListener("click", (event) => {
    if (event.detail === 0 && !isOff(button) && performance.now() - pressedMs >= AFTER_MS) click();
  });
}

// A button that acts after it was pressed for 0.6 s; its ring fills meanwhile. act(): pressed long enough.
// name: of what it does, or a function of it; tell(text) says it where the button was let go too early, or clicked by
// a screen reader: its second click acts.
export function holdButton(button, act, name, words, tell) {
  let timer = null;
  let clickedMs = -Infinity;

  const hint = (key) => tell(words.say(key, { name: typeof name === "function" ? name() : name }));
  const stop = () => {
    clearTimeout(timer);
    timer = null;
    button.classList.remove("pressing");
  };
  button.addEventListener("blur", stop);
  onPress(button, ["pointerup", "pointerleave", "pointercancel"], {
    start() {
      if (timer !== null || isOff(button)) return;
      button.classList.add("pressing");
      timer = setTimeout(() => {
        stop();
        navigator.vibrate?.(40);
        act();
      }, PRESS_MS);
    },
    end() {
      if (timer === null) return;
      stop();
      hint("go.longer");
    },
    click() {
      const now = performance.now();
      const isSecond = now - clickedMs < CONFIRM_MS;
      clickedMs = isSecond ? -Infinity : now;
      if (isSecond) act();
      else hint("go.again");
    },
  });
}
