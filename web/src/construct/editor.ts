// The scenario as the server has it: what it is, and what is wanted of it.

import { say } from "../say";
import { decodeAnswer, decodeLibrary, decodeState, type Answer, type EditState, type Library, type Refusal, type Want } from "./protocol";

export class Editor {
  private constructor(
    readonly library: Library,
    private known: EditState,
    private readonly show: (state: EditState) => void,
    private readonly refuse: (refusal: Refusal | null) => void,
  ) {}

  /** Asks for everything once; `show` is called with every change, `refuse` with what is not done, and with nothing once something is. */
  static async open(show: (state: EditState) => void, refuse: (refusal: Refusal | null) => void): Promise<Editor> {
    const [library, state] = await Promise.all([read("api/library"), read("api/edit")]);
    return new Editor(decodeLibrary(library), decodeState(state), show, refuse);
  }

  get state(): EditState {
    return this.known;
  }

  /** Wants something of the files; true if it was done. */
  async want(want: Want): Promise<boolean> {
    const body = want.want === "reload" ? want : { ...want, revision: this.known.revision };
    let answer: Answer;
    try {
      const response = await fetch("api/edit", { method: "POST", body: JSON.stringify(body) });
      answer = decodeAnswer(await response.json());
    } catch (error) {
      this.refuse({ message: say("the editor does not answer: {error}", { error: describe(error) }), file: null, line: null, references: [] });
      return false;
    }
    this.refuse(answer.error);
    if (answer.state !== null) {
      this.known = answer.state;
      this.show(this.known);
    }
    return answer.error === null;
  }
}

async function read(path: string): Promise<unknown> {
  const answer = await fetch(path);
  if (!answer.ok) throw new Error(`${path}: the server answers ${answer.status} ${answer.statusText}`);
  return answer.json();
}

function describe(error: unknown): string {
  return error instanceof Error ? error.message : String(error);
}
