// JSON that arrived, read field by field; what is wrong is reported with its place.

/** A place that cannot be read, and why. */
export class ProtocolError extends Error {
  constructor(
    readonly place: string,
    readonly reason: string,
  ) {
    super(`${place}: ${reason}`);
    this.name = "ProtocolError";
  }
}

export type Json = string | number | boolean | readonly Json[] | { readonly [key: string]: Json } | null;

/** A value of JSON with the place that it was found at. */
export class Field {
  constructor(
    readonly value: unknown,
    readonly place: string,
  ) {}

  fail(reason: string): never {
    throw new ProtocolError(this.place, reason);
  }

  /** The value of a key; `preset` in its place where it is absent. */
  at(key: string, preset?: unknown): Field {
    if (typeof this.value !== "object" || this.value === null || Array.isArray(this.value)) this.fail("is not an object");
    const value = (this.value as Record<string, unknown>)[key];
    const isAbsent = value === undefined || value === null;
    return new Field(isAbsent && preset !== undefined ? preset : value, this.place === "" ? key : `${this.place}.${key}`);
  }

  /** Fails because of the word `kind` at `key`, which no member of a union has. */
  unknown(key: string, kind: string): never {
    const place = this.place === "" ? key : this.place;
    throw new ProtocolError(place, `is a \`${kind}\`, which this page does not have`);
  }

  get isAbsent(): boolean {
    return this.value === undefined || this.value === null;
  }

  text(): string {
    return typeof this.value === "string" ? this.value : this.fail("is not a text");
  }

  number(): number {
    return typeof this.value === "number" && Number.isFinite(this.value) ? this.value : this.fail("is not a number");
  }

  flag(): boolean {
    return typeof this.value === "boolean" ? this.value : this.fail("is not true or false");
  }

  list<T>(read: (item: Field) => T): T[] {
    if (!Array.isArray(this.value)) this.fail("is not a list");
    return this.value.map((item, index) => read(new Field(item, `${this.place}[${index}]`)));
  }

  entries<T>(read: (key: string, item: Field) => T): T[] {
    if (typeof this.value !== "object" || this.value === null) this.fail("is not an object");
    return Object.keys(this.value).map((key) => read(key, this.at(key)));
  }

  /** What `read` makes of it, or `fallback` where the optional field is not there. */
  or<T>(fallback: T, read: (field: Field) => T): T {
    return this.isAbsent ? fallback : read(this);
  }
}

/** Reads a value, or fails with the place that is wrong. */
export type Reader<T> = (field: Field) => T;

export const text = (field: Field): string => field.text();
export const number = (field: Field): number => field.number();
export const flag = (field: Field): boolean => field.flag();

/** Any value; whoever uses it looks at what it is. */
export function json(field: Field): Json {
  const value = field.value;
  if (value === undefined) return null;
  if (value === null || typeof value === "string" || typeof value === "boolean") return value;
  if (typeof value === "number") return field.number();
  if (Array.isArray(value)) return field.list(json);
  return Object.fromEntries(field.entries((key, item) => [key, json(item)]));
}

/** A whole number: a place, a count, nanoseconds. */
export function whole(field: Field): number {
  const value = field.number();
  return Number.isInteger(value) ? value : field.fail("is not a whole number");
}

/** A text of this form. */
export const matching = (form: RegExp) => (field: Field): string => {
  const value = field.text();
  return form.test(value) ? value : field.fail(`is \`${value}\`, which is not of the form ${form.source}`);
};

/** One of these words. */
export const one_of = <T extends string>(...words: readonly T[]) => (field: Field): T => {
  const value = field.text();
  return words.find((word) => word === value) ?? field.fail(`is \`${value}\`: ${words.join(", ")}`);
};

export const nullable = <T>(read: Reader<T>) => (field: Field): T | null => field.or<T | null>(null, read);
export const list = <T>(read: Reader<T>) => (field: Field): readonly T[] => field.list(read);
export const set = <T>(read: Reader<T>) => (field: Field): ReadonlySet<T> => new Set(field.list(read));

/** A list with one item for each reader. */
export const tuple = <T extends readonly unknown[]>(...readers: { readonly [K in keyof T]: Reader<T[K]> }) => (field: Field): T => {
  const items = field.list((item) => item);
  if (items.length !== readers.length) field.fail(`has ${items.length} items instead of ${readers.length}`);
  return items.map((item, place) => readers[place]?.(item)) as unknown as T;
};

/** Values by texts. */
export const map = <T>(read: Reader<T>) => (field: Field): ReadonlyMap<string, T> =>
  new Map(field.entries((key, item) => [key, read(item)] as const));

/** Values by whole numbers. */
export const numbered = <T>(read: Reader<T>) => (field: Field): ReadonlyMap<number, T> =>
  new Map(field.entries((key, item) => [/^-?\d+$/.test(key) ? Number(key) : item.fail("has a key that is not a number"), read(item)] as const));
