// A key that is held down: its signal rises and falls once for each press, however short.

/** Where the session does not show that the key is down, it is let go after this, ms. */
const LONGEST_MS = 1000;
/** It is down for at least this, so that an eye sees it, ms. */
const SHORTEST_MS = 100;

export class Press {
  private isDown = false;
  /** Whether the session has shown that it is down. */
  private hasRisen = false;
  private isLetGo = false;
  private isOld = false;
  private turn = 0;

  /** `write` gives it to the session; `after` does something so many milliseconds later. */
  constructor(
    private readonly write: (value: number) => void,
    private readonly after: (deed: () => void, ms: number) => void,
    private readonly isHeld: () => boolean = () => false,
  ) {}

  /** The key goes down or up. */
  press(isDown: boolean): void {
    if (isDown) {
      if (this.isDown) {
        // Pressed again before the last press was over.
        this.isLetGo = false;
        return;
      }
      [this.isDown, this.hasRisen, this.isLetGo, this.isOld] = [true, false, false, false];
      const turn = (this.turn += 1);
      this.write(1);
      this.after(() => this.age(turn, false), SHORTEST_MS);
      this.after(() => this.age(turn, true), LONGEST_MS);
    } else if (this.isDown) {
      this.isLetGo = true;
      this.settle();
    }
  }

  /** What the session shows of the signal. */
  seen(isDown: boolean): void {
    if (isDown && this.isDown) this.hasRisen = true;
    this.settle();
  }

  private age(turn: number, isLast: boolean): void {
    if (turn !== this.turn) return;
    // While time stands there is no step in which it could rise.
    if (isLast && this.isHeld()) return this.after(() => this.age(turn, true), LONGEST_MS);
    this.isOld = true;
    if (isLast) this.hasRisen = true;
    this.settle();
  }

  /** Lets go once it has been let go, seen, and was down long enough for one step at least. */
  private settle(): void {
    if (!this.isDown || !this.isLetGo || !this.hasRisen || !this.isOld) return;
    this.isDown = false;
    this.write(0);
  }
}
