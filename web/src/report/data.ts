// The data of a chart, as a report brings it along.

import { local } from "../format";

export interface Chart {
  readonly runs: readonly string[];
  readonly panels: readonly ChartPanel[];
  readonly marks: readonly { readonly t_ns: number; readonly label: string }[];
}

export interface ChartPanel {
  readonly signal: string;
  readonly unit: string | null;
  /** It holds a value until the next one. */
  readonly steps: boolean;
  readonly names: readonly (readonly [number, string])[];
  readonly runs: readonly { readonly t_ns: readonly number[]; readonly values: readonly (number | null)[] }[];
}

/** Times of all runs, and the values of each run there: nothing between its samples, which is not a gap. */
export function aligned(panel: ChartPanel): [number[], ...(number | null | undefined)[][]] {
  const all_ns = [...new Set(panel.runs.flatMap((run) => run.t_ns))].sort((a, b) => a - b);
  const rows = panel.runs.map((run) => {
    const by_time = new Map(run.t_ns.map((t_ns, index) => [t_ns, run.values[index] ?? null]));
    return all_ns.map((t_ns) => by_time.get(t_ns));
  });
  return [all_ns.map((t_ns) => t_ns / 1e9), ...rows];
}

/** The value of a run at a time: the last one before, or between two for what moves steadily. */
export function value_at(panel: ChartPanel, run: number, t_s: number): number | null {
  const samples = panel.runs[run];
  if (samples === undefined) return null;
  let [low, high] = [0, samples.t_ns.length];
  while (low < high) {
    const middle = (low + high) >> 1;
    if ((samples.t_ns[middle] as number) / 1e9 <= t_s) low = middle + 1;
    else high = middle;
  }
  const [before, after] = [samples.values[low - 1] ?? null, samples.values[low] ?? null];
  if (before === null || panel.steps || after === null) return low === samples.t_ns.length && !ends_at(samples.t_ns, t_s) ? null : before;
  const [from_s, to_s] = [(samples.t_ns[low - 1] as number) / 1e9, (samples.t_ns[low] as number) / 1e9];
  return before + ((after - before) * (t_s - from_s)) / (to_s - from_s);
}

function ends_at(t_ns: readonly number[], t_s: number): boolean {
  const last_ns = t_ns[t_ns.length - 1];
  return last_ns !== undefined && t_s <= last_ns / 1e9;
}

/** A value as it is read: by its name, or as a number with its unit. */
export function written(panel: ChartPanel, value: number | null): string {
  if (value === null) return "–";
  const name = panel.names.find(([known]) => known === value)?.[1];
  if (name !== undefined) return name;
  return `${local(String(Number(value.toPrecision(6))))}${panel.unit === null ? "" : ` ${panel.unit}`}`;
}
