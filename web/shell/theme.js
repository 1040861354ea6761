/** The theme button. */
import { byId, setText } from "../dom.js";
import { loadTheme, saveTheme } from "./storage.js";

const THEMES = /** @type {const} */ (["system", "light", "dark"]);

/** Applies the saved theme and the selected ones. */
export function createTheme() {
  const button = byId("theme");
  let theme = THEMES.find((name) => name === loadTheme()) ?? "system";
  const apply = () => {
    document.documentElement.dataset.theme = theme;
    setText(button, `Colors: ${theme}`);
    document.dispatchEvent(new Event("themechange"));
  };
  button.addEventListener("click", () => {
    theme = THEMES[(THEMES.indexOf(theme) + 1) % THEMES.length];
    saveTheme(theme);
    apply();
  });
  for (const query of ["(prefers-color-scheme: dark)", "(forced-colors: active)"])
    matchMedia(query).addEventListener("change", apply);
  apply();
}
