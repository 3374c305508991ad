// Day and night: as the device wants it, until the button is pressed.

export function wireTheme(button) {
  const root = document.documentElement;
  const saved = read();
  if (saved === "dark" || saved === "light") root.dataset.theme = saved;
  button.addEventListener("click", () => {
    const isDark = root.dataset.theme
      ? root.dataset.theme === "dark"
      : matchMedia("(prefers-color-scheme: dark)").matches;
    root.dataset.theme = isDark ? "light" : "dark";
    try {
      localStorage.setItem("theme", root.dataset.theme);
    } catch {
      // a private window keeps nothing
    }
  });
}

function read() {
  try {
    return localStorage.getItem("theme");
  } catch {
    return null;
  }
}
