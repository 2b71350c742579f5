// Charts of a report: each picture that brings its data becomes one; on paper the picture stays.

import "uplot/dist/uPlot.min.css";
import "./report.css";
import { ChartView } from "./chart";
import type { Chart } from "./data";

const views: ChartView[] = [];
for (const script of document.querySelectorAll<HTMLScriptElement>('figure > script[type="application/json"]')) {
  const figure = script.parentElement;
  if (figure === null) continue;
  // The program that wrote the report wrote this, too.
  const view = new ChartView(JSON.parse(script.text) as Chart, `charts-${views.length}`);
  figure.append(view.root);
  figure.classList.add("charted");
  views.push(view);
}
window.matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => {
  for (const view of views) view.repaint();
});
