// SPDX-License-Identifier: MIT
// The page behind a withdrawal link: asks once more, then has the answers deleted. It enrols nobody.
import { RequestFailed, request } from "./api";
import type { Study } from "./contract";
import { patiently } from "./delivery";
import { Outbox } from "./outbox";
import { choose, page, showMessage } from "./screens";
import { forgetSession, savedSession } from "./session";
import type { Texts } from "./texts";

export async function withdrawByLink(withdrawal: string, study: Study, texts: Texts): Promise<void> {
  const words = { title: texts.withdraw_title, text: texts.withdraw_text };
  await choose(page(), texts, words, [texts.withdraw_yes]);
  const body = { submission_id: crypto.randomUUID(), withdrawal };
  try {
    await patiently(page(), texts, () => request("/api/withdraw_by_link", { body }));
  } catch (cause) {
    if (!(cause instanceof RequestFailed && (cause.status === 404 || cause.status === 422))) throw cause;
    showMessage(page(), texts, { title: texts.withdrawal_unknown_title, text: texts.withdrawal_unknown_text });
    return;
  }
  await forgetDeadVisit(study);
  showMessage(page(), texts, { title: texts.withdrawn_title, text: texts.withdrawn_text });
}

/** Removes what this browser holds of the deleted visit. A visit of somebody else, on a shared computer, stays. */
async function forgetDeadVisit(study: Study): Promise<void> {
  const session = savedSession(study.name);
  if (!session) return;
  try {
    await request("/api/next", { token: session.token });
  } catch (cause) {
    if (!(cause instanceof RequestFailed && cause.status === 401)) return;
    await (await Outbox.open(study.name)).discard(session.token);
    forgetSession(study.name);
  }
}
