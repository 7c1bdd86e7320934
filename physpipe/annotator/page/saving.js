// Sends the newest of what was said, until the server has it.

import { settle } from "./conflict.js";
import * as journal from "./journal.js";
import { page } from "./page.js";
import { Said, sameSaid } from "./said.js";
import { Refused, ask, clipPath } from "./server.js";
import { alarm, listClips, tellSaved } from "./telling.js";

const RETRY_MS = 2000;

export async function save(session) {
  if (session.busy) return;
  session.busy = true;
  let trouble = null;
  while (session.said !== session.saved && !trouble) {
    tellSaved();
    const sent = session.said;
    const change = { place: page.set.place, revision: session.revision, state: sent.toRows() };
    try {
      const { revision } = await persistently(() => ask(clipPath(session.clip.name), "PUT", change));
      [session.revision, session.saved] = [revision, sent];
    } catch (error) {
      if (error.code === 409) await meet(session, sent, error.answer);
      else trouble = error;
    }
  }
  session.busy = false;
  if (!trouble) journal.drop(session.clip.name);
  alarm(trouble && `${session.clip.name} is not saved; this browser keeps your changes. ${trouble.message}`);
  tellSaved(trouble ? "not saved" : "");
  listClips();
}

// Tries until the server answers; whatever it answers counts.
async function persistently(request) {
  for (;;) {
    try {
      return await request();
    } catch (error) {
      if (error instanceof Refused) throw error;
      tellSaved("the server does not answer; kept in this browser, trying again");
      await new Promise((done) => setTimeout(done, RETRY_MS));
    }
  }
}

// The server holds something else than the change began with: what was sent before its answer got lost, or another's.
async function meet(session, sent, { revision, state }) {
  const theirs = Said.fromRows(state);
  session.revision = revision;
  if (sameSaid(theirs, sent)) session.saved = sent;
  else await settle(session, theirs, "Yours");
}

// Takes over what tabs that are gone left behind for the clip; returns what to tell of it.
export async function adopt(session) {
  let told = "";
  for (const left of await journal.orphans(session.clip.name)) {
    const [now, mine] = [session.said, Said.fromRows(left.state)];
    if (!sameSaid(mine, now)) {
      session.said = mine;
      journal.keep(session);
      if (left.revision === session.revision) {
        session.remember(now);
        told = "Changes that were not saved when this page was last open are back.";
      } else {
        await settle(session, now, `What this browser kept from ${new Date(left.at).toLocaleString()}`);
      }
      await save(session);
    }
    journal.drop(session.clip.name, left.tab);
  }
  return told;
}
