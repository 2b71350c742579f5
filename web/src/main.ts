// The page: reads the session's structure, opens the connection and puts the views together.

import { say, translate } from "./say";
import "uplot/dist/uPlot.min.css";
import "./page.css";
import { frame, make } from "./dom";
import { live_address } from "./link";
import { Page } from "./page";
import { ProtocolError } from "./field";
import { decodeSession } from "./session";
import { fail, shoot, wanted } from "./shot";
import { begin_split } from "./split";
import { begin_words } from "./header";
import { begin_theme } from "./theme";

async function begin(): Promise<void> {
  begin_words();
  begin_theme();
  const answer = await fetch("api/session");
  if (!answer.ok) throw new ProtocolError("api/session", `the server answers ${answer.status} ${answer.statusText}`);
  const session = decodeSession(await answer.json());
  translate(session.translations);
  if (picture === null) {
    begin_split();
    new Page(session);
  }
  else shoot(session, live_address(), picture);
}

const picture = wanted(window.location.search);

begin().catch((error: unknown) => {
  if (picture !== null) return void fail(error);
  const notice = frame("notice");
  const text = error instanceof Error ? error.message : String(error);
  const again = make("button", { type: "button" }, say("Try again"));
  again.addEventListener("click", () => window.location.reload());
  notice.replaceChildren(say("The session cannot be read: {text}.", { text }), " ", again);
  notice.hidden = false;
});
