// Canvases that are as sharp as the screen, and drawn anew when day or night comes.

const MOST_DENSITY = 3;

export function sharpened(canvas, width, height) {
  const density = Math.min(devicePixelRatio || 1, MOST_DENSITY);
  const [wide, high] = [Math.round(width * density), Math.round(height * density)];
  if (canvas.width !== wide || canvas.height !== high) [canvas.width, canvas.height] = [wide, high];
  return density;
}

// Calls until the canvas is removed.
export function whenLight(canvas, changed) {
  const dark = matchMedia("(prefers-color-scheme: dark)");
  const watch = new MutationObserver(() => call());
  const call = () => {
    if (canvas.isConnected) changed();
    else {
      dark.removeEventListener("change", call);
      watch.disconnect();
    }
  };
  dark.addEventListener("change", call);
  watch.observe(document.documentElement, { attributeFilter: ["data-theme"] });
}
