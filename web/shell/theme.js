/** The theme button. */
import { byId, setText } from "../dom.js";
import { loadTheme, saveTheme } from "./storage.js";

const THEMES = {
  system: ["◐", "Colors: system"],
  light: ["☀", "Colors: light"],
  dark: ["☾", "Colors: dark"],
};

/** Applies the saved theme and the selected ones. */
export function createTheme() {
  const button = byId("theme");
  const names = /** @type {(keyof typeof THEMES)[]} */ (Object.keys(THEMES));
  let theme = names.find((name) => name === loadTheme()) ?? "system";
  const apply = () => {
    document.documentElement.dataset.theme = theme;
    const [sign, label] = THEMES[theme];
    setText(button, sign);
    button.title = label;
    button.setAttribute("aria-label", label);
    document.dispatchEvent(new Event("themechange"));
  };
  button.addEventListener("click", () => {
    theme = names[(names.indexOf(theme) + 1) % names.length];
    saveTheme(theme);
    apply();
  });
  for (const query of ["(prefers-color-scheme: dark)", "(forced-colors: active)"])
    matchMedia(query).addEventListener("change", apply);
  apply();
}
