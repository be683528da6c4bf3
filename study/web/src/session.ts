// SPDX-License-Identifier: MIT
// One participant's visit: who they are to the server, kept in the browser so that a reload goes on with it.
import { RequestFailed, request } from "./api";
import type { Environment } from "./contract";

const SOURCES = ["link", "lab", "pilot", "simulated"] as const;
type Source = (typeof SOURCES)[number];

export interface Session {
  token: string;
  participant_id: string;
  session_id: string;
}

/** What the address of the page says: ?source=lab&simulate_key=…&lang=de. */
export interface Visit {
  /** null: the server's own default. */
  source: Source | null;
  simulate_key: string | null;
  lang: string | null;
}

export function visitFrom(address: string): Visit {
  const asked = new URL(address).searchParams;
  const source = SOURCES.find((known) => known === asked.get("source")) ?? null;
  return { source, simulate_key: asked.get("simulate_key"), lang: asked.get("lang") };
}

const keyOf = (study_name: string): string => `verisim session ${study_name}`;
const seqKeyOf = (session: Session): string => `verisim event ${session.session_id}`;

export function savedSession(study_name: string): Session | null {
  const saved = localStorage.getItem(keyOf(study_name));
  return saved === null ? null : (JSON.parse(saved) as Session);
}

export function forgetSession(study_name: string): void {
  const session = savedSession(study_name);
  if (session) localStorage.removeItem(seqKeyOf(session));
  localStorage.removeItem(keyOf(study_name));
}

/** Number of the next event of this visit; goes on counting after a reload. */
export function nextEventNumber(session: Session): number {
  const number = Number(localStorage.getItem(seqKeyOf(session)) ?? "0");
  localStorage.setItem(seqKeyOf(session), String(number + 1));
  return number;
}

/** Enrols a new participant. Throws RequestFailed; to be called again with the same `submission_id` when that passes. */
export async function openSession(
  study_name: string,
  visit: Visit,
  environment: Environment,
  submission_id: string,
): Promise<Session> {
  const body = { source: visit.source, simulate_key: visit.simulate_key, environment };
  let session: Session;
  try {
    session = await request<Session>("/api/sessions", { body: { submission_id, ...body } });
  } catch (cause) {
    // The server has this enrolment but its answer, and with it the token, got lost on the way: enrol afresh.
    if (!(cause instanceof RequestFailed && cause.status === 409)) throw cause;
    session = await request<Session>("/api/sessions", { body: { submission_id: crypto.randomUUID(), ...body } });
  }
  const { token, participant_id, session_id } = session;
  localStorage.setItem(keyOf(study_name), JSON.stringify({ token, participant_id, session_id }));
  return { token, participant_id, session_id };
}
