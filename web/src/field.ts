// JSON that arrived, read field by field; what is wrong is told with its place.

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

/** A value of JSON with the place that it was found at. */
export class Field {
  constructor(
    readonly value: unknown,
    readonly place: string,
  ) {}

  fail(reason: string): never {
    throw new ProtocolError(this.place, reason);
  }

  at(key: string): Field {
    if (typeof this.value !== "object" || this.value === null || Array.isArray(this.value)) this.fail("is not an object");
    return new Field((this.value as Record<string, unknown>)[key], this.place === "" ? key : `${this.place}.${key}`);
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

  /** Exactly `count` numbers. */
  numbers(count: number): number[] {
    const all = this.list((item) => item.number());
    return all.length === count ? all : this.fail(`has ${all.length} numbers instead of ${count}`);
  }

  /** A parameter as it is shown. */
  shown(): string {
    if (typeof this.value === "string") return this.value;
    return JSON.stringify(this.value) ?? this.fail("is not there");
  }
}

export const text = (field: Field): string => field.text();
export const number = (field: Field): number => field.number();
export const flag = (field: Field): boolean => field.flag();
export const nullableText = (field: Field): string | null => field.or<string | null>(null, text);
