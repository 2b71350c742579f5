// Dark or light: as the system has it, also when it changes, or as the viewer chose.

import { frame } from "./dom";

const KEY = "onescan-theme";

/** The theme after the viewer's key: what differs from the system is kept, what does not follows the system again. */
export function chosen(now: string, by_system: string): { readonly theme: string; readonly kept: string | null } {
  const theme = now === "dark" ? "light" : "dark";
  return { theme, kept: theme === by_system ? null : theme };
}

/** Sets the theme and lets the header's button change it. */
export function begin_theme(): void {
  const system = window.matchMedia("(prefers-color-scheme: dark)");
  const by_system = (): string => (system.matches ? "dark" : "light");
  const put = (theme: string): void => {
    if (document.documentElement.dataset.theme === theme) return;
    document.documentElement.dataset.theme = theme;
    window.dispatchEvent(new Event("themechange"));
  };
  put(window.localStorage.getItem(KEY) ?? by_system());
  system.addEventListener("change", () => {
    if (window.localStorage.getItem(KEY) === null) put(by_system());
  });
  frame("theme").addEventListener("click", () => {
    const { theme, kept } = chosen(document.documentElement.dataset.theme ?? by_system(), by_system());
    if (kept === null) window.localStorage.removeItem(KEY);
    else window.localStorage.setItem(KEY, kept);
    put(theme);
  });
}

/** A colour of the theme. */
export function colour(name: string): string {
  return getComputedStyle(document.documentElement).getPropertyValue(name).trim();
}
