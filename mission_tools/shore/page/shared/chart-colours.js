// The colours of the planner's pictures, by day and by night.

const DAY = {
  water: "#b7daeb", land: "#efe6cf", shore: "#9c8f6d", island: "#dfe3bd", structure: "#8d6e4f", structureEdge: "#4e3b28",
  keep: "#c2413b", keepFill: "rgba(246, 213, 208, 0.75)", route: "#cf3a2e", track: "#12395b", halo: "#ffffff",
  ink: "#26231f", soft: "#6a655d", card: "#ffffff", grid: "rgba(18, 57, 91, 0.18)", fence: "#7a4a00",
  hull: "#ffffff", unheard: "#9aa0a5", hullEdge: "#12395b", echo: "rgba(18, 57, 91, 0.22)", echoEdge: "#12395b", obstacle: "#a3195b", vessel: "#1d6b3a",
};
const NIGHT = {
  water: "#1d4257", land: "#33322a", shore: "#86805f", island: "#3d4030", structure: "#a58767", structureEdge: "#d8c3a8",
  keep: "#ff8a80", keepFill: "rgba(85, 48, 46, 0.75)", route: "#ff7a66", track: "#9fd0ff", halo: "#15181b",
  ink: "#e9e6df", soft: "#a09a8f", card: "#1d2226", grid: "rgba(159, 208, 255, 0.16)", fence: "#ffc45c",
  hull: "#15181b", unheard: "#6f767c", hullEdge: "#9fd0ff", echo: "rgba(159, 208, 255, 0.2)", echoEdge: "#9fd0ff", obstacle: "#ff8fc4", vessel: "#7fd39a",
};

export function isNight() {
  const theme = document.documentElement.dataset.theme;
  return theme ? theme === "dark" : matchMedia("(prefers-color-scheme: dark)").matches;
}

export const colours = () => (isNight() ? NIGHT : DAY);
