// SPDX-FileCopyrightText: 2026 the psfm authors
// SPDX-License-Identifier: BSD-3-Clause
import { SIGNED_IN } from "./events";

/** What a page says that has no link, or none any more. */
export const NO_LINK = "this page wants the link that you were given; if it was opened here before, it has run out or has been taken back: ask for a new one";

/** The token in a link's fragment, which no server is sent, becomes a cookie, which no script can read. */
export async function signIn(): Promise<void> {
  const token = /^#token=([\w-]+)$/.exec(location.hash)?.[1];
  if (!token) return;
  history.replaceState(null, "", location.pathname);
  const answer = await fetch("/api/v1/login", { method: "POST", credentials: "same-origin", headers: { "Content-Type": "application/json" }, body: JSON.stringify({ token }) })
    .catch(() => { throw new Error("the server does not answer; open the link again later"); });
  if (answer.status === 429) throw new Error("too many wrong links were opened from here; open yours again in a minute");
  if (!answer.ok) throw new Error("this link has run out or has been taken back, or was never one; ask for a new one");
  try { localStorage.setItem(SIGNED_IN, String(Date.now())); } catch { /* a browser that keeps nothing has no other pages to tell */ }
}
