// Places on a grid, as numbers that people would write.

/** The nearest place on the grid; without one, to a tenth of a millimetre. */
export function snap(value_m: number, grid_m: number): number {
  const step_m = grid_m > 0 ? grid_m : 1e-4;
  return Number((Math.round(value_m / step_m) * step_m).toFixed(6));
}

/** A name without the range or the index at its end. */
export function base(name: string): string {
  return name.split("[")[0] ?? name;
}

/** A name that is free: `box`, `box_2`, … */
export function free(wanted: string, taken: readonly string[]): string {
  const known = new Set(taken.map(base));
  if (!known.has(wanted)) return wanted;
  let number = 2;
  while (known.has(`${wanted}_${number}`)) number += 1;
  return `${wanted}_${number}`;
}
