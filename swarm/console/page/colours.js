// Colours that people with any colour vision tell apart (Okabe and Ito), and those of the theme.

const ROBOTS = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#8c6d31"];
const SKIRTS = { red: "#d7263d", blue: "#1f5fbf", green: "#1f8a4c", yellow: "#e3b505", orange: "#f28c28", purple: "#7d3c98" };
const DASHES = [[], [7, 4], [2, 3], [9, 3, 2, 3]];

let theme = null;
let themeIsDark = null;

/** The theme's colours by name, read once for each of the two themes. */
export function colours() {
  const isDark = matchMedia("(prefers-color-scheme: dark)").matches;
  if (theme === null || isDark !== themeIsDark) {
    const style = getComputedStyle(document.documentElement);
    const names = ["panel", "line", "ink", "quiet", "accent", "good", "warn", "bad", "floor", "cell", "cell-line", "wall", "heat-low", "heat-high", "path"];
    theme = Object.fromEntries(names.map((name) => [name, style.getPropertyValue(`--${name}`).trim()]));
    themeIsDark = isDark;
  }
  return theme;
}

/** The colour of the robot with a number; beyond seven they come again, with other dashes. */
export const robotColour = (number) => ROBOTS[number % ROBOTS.length];
export const robotDash = (number) => DASHES[Math.floor(number / ROBOTS.length) % DASHES.length];
export const skirtColour = (name) => SKIRTS[name] ?? "#d7263d";

const channels = (colour) => [1, 3, 5].map((at) => parseInt(colour.slice(at, at + 2), 16));

/** Between two colours, share 0 to 1. */
export function between(low, high, share) {
  const [a, b] = [channels(low), channels(high)];
  return `rgb(${a.map((value, at) => Math.round(value + (b[at] - value) * share)).join(" ")})`;
}
