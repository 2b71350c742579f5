// The page: reads the session's structure, opens the connection and puts the views together.

import "uplot/dist/uPlot.min.css";
import "./page.css";
import { frame, make } from "./dom";
import { Page } from "./page";
import { ProtocolError, decodeSession } from "./protocol";
import { begin_theme } from "./theme";

async function begin(): Promise<void> {
  begin_theme();
  const answer = await fetch("api/session");
  if (!answer.ok) throw new ProtocolError("api/session", `the server answers ${answer.status} ${answer.statusText}`);
  new Page(decodeSession(await answer.json()));
}

begin().catch((error: unknown) => {
  const notice = frame("notice");
  const text = error instanceof Error ? error.message : String(error);
  const again = make("button", { type: "button" }, "Try again");
  again.addEventListener("click", () => window.location.reload());
  notice.replaceChildren(`The session cannot be read: ${text}. `, again);
  notice.hidden = false;
});
