// The sheets beside the machine, one at a time, as tabs (WAI-ARIA Authoring Practices, tabs).

import { frame, make } from "./dom";
import { say, type Text } from "./say";

export class Sheets {
  private readonly all: { name: string; tab: HTMLButtonElement; heading: HTMLElement; sheet: HTMLElement }[] = [];

  constructor(private readonly opened: (name: string) => void) {
    frame("tabs").addEventListener("keydown", (event) => {
      const way = event.key === "ArrowRight" ? 1 : event.key === "ArrowLeft" ? -1 : 0;
      const now = this.all.findIndex((one) => one.tab === document.activeElement);
      const next = this.all[(now + way + this.all.length) % this.all.length];
      if (way === 0 || now < 0 || next === undefined) return;
      this.open(next.name);
      next.tab.focus();
    });
  }

  add(name: Text, sheet: HTMLElement): void {
    const id = `${name.toLowerCase()}-sheet`;
    const tab = make("button", { type: "button", role: "tab", id: `${id}-tab`, "aria-controls": id }, say(name));
    tab.addEventListener("click", () => this.open(name));
    sheet.id = id;
    sheet.setAttribute("role", "tabpanel");
    sheet.setAttribute("aria-labelledby", tab.id);
    frame("tabs").append(tab);
    // Who goes from heading to heading finds the sheet that is open, and what is in it one level below.
    const heading = make("h2", { class: "visually-hidden" }, say(name));
    frame("sheets").append(heading, sheet);
    this.all.push({ name, tab, heading, sheet });
    this.open(this.all[0]?.name ?? name);
  }

  open(name: string): void {
    for (const one of this.all) {
      const isOpen = one.name === name;
      one.tab.setAttribute("aria-selected", String(isOpen));
      one.tab.tabIndex = isOpen ? 0 : -1;
      one.sheet.hidden = one.heading.hidden = !isOpen;
    }
    this.opened(name);
  }
}
