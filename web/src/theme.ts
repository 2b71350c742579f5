// Dark or light: as the system has it, or as the viewer chose.

import { frame } from "./dom";

const KEY = "onescan-theme";

/** Sets the theme and lets the header's button change it. */
export function begin_theme(): void {
  const by_system = window.matchMedia("(prefers-color-scheme: dark)").matches ? "dark" : "light";
  document.documentElement.dataset.theme = window.localStorage.getItem(KEY) ?? by_system;
  frame("theme").addEventListener("click", () => {
    const theme = document.documentElement.dataset.theme === "dark" ? "light" : "dark";
    document.documentElement.dataset.theme = theme;
    window.localStorage.setItem(KEY, theme);
    window.dispatchEvent(new Event("themechange"));
  });
}

/** A colour of the theme. */
export function colour(name: string): string {
  return getComputedStyle(document.documentElement).getPropertyValue(name).trim();
}
