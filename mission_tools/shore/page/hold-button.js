// A button that acts after it was pressed for 0.6 s, by finger, mouse or keyboard. Its ring fills meanwhile.

const PRESS_MS = 600; // as long as the ring's transition in style.css
const CONFIRM_MS = 5_000;

// act(): pressed long enough. hint(isByScreenReader): let go too early, or clicked by a screen reader, which
// cannot press for long: its second click acts.
export function holdButton(button, act, hint) {
  let timer = null;
  let pressedAt = -Infinity;
  let clickedAt = -Infinity;

  const start = () => {
    if (timer !== null || isOff(button)) return;
    pressedAt = performance.now();
    button.classList.add("pressing");
    timer = setTimeout(() => {
      stop();
      navigator.vibrate?.(40);
      act();
    }, PRESS_MS);
  };
  const stop = () => {
    clearTimeout(timer);
    timer = null;
    button.classList.remove("pressing");
  };
  const letGo = () => {
    if (timer === null) return;
    stop();
    hint(false);
  };

  button.addEventListener("pointerdown", (event) => event.button === 0 && start());
  for (const name of ["pointerup", "pointerleave", "pointercancel"]) button.addEventListener(name, letGo);
  button.addEventListener("contextmenu", (event) => event.preventDefault());
  button.addEventListener("blur", stop);
  button.addEventListener("keydown", (event) => {
    if (event.key !== " " && event.key !== "Enter") return;
    event.preventDefault();
    if (!event.repeat) start();
  });
  button.addEventListener("keyup", (event) => {
    if (event.key !== " " && event.key !== "Enter") return;
    event.preventDefault();
    letGo();
  });
  button.addEventListener("click", (event) => {
    const now = performance.now();
    if (event.detail !== 0 || isOff(button) || now - pressedAt < 1_500) return; // not a screen reader's
    if (now - clickedAt < CONFIRM_MS) {
      clickedAt = -Infinity;
      act();
    } else {
      clickedAt = now;
      hint(true);
    }
  });
}

const isOff = (button) => button.disabled || button.closest("fieldset:disabled") !== null;
