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

/** Who a recruitment platform says the participant is. */
interface External {
  platform: "prolific" | "mturk" | "other";
  participant: string;
  study: string | null;
  session: string | null;
}

/** What the address of the page says: ?source=lab&lang=de, ?link=…, or what a recruitment platform adds. */
export interface Visit {
  /** null: the server's own default. */
  source: Source | null;
  simulate_key: string | null;
  lang: string | null;
  link: string | null;
  external: External | null;
  /** A worker looks at the task without having accepted it: nobody is enrolled. */
  is_preview: boolean;
  /** The secret of a link that deletes the answers of a visit. */
  withdrawal: string | null;
}

const ADDRESS_KEY = "verisim address";

export function visitFrom(address: string): Visit {
  const { searchParams: asked, hash } = new URL(address);
  const source = SOURCES.find((known) => known === asked.get("source")) ?? null;
  return {
    source,
    simulate_key: asked.get("simulate_key"),
    lang: asked.get("lang"),
    link: asked.get("link"),
    external: externalFrom(asked),
    is_preview: asked.get("assignmentId") === "ASSIGNMENT_ID_NOT_AVAILABLE",
    withdrawal: new URLSearchParams(hash.slice(1)).get("withdraw"),
  };
}

/** Outside names as platforms make them; anything else in the address is left alone and never sent. */
const OUTSIDE_NAME = /^[A-Za-z0-9_.@-]{1,100}$/;

function externalFrom(asked: URLSearchParams): External | null {
  const taken = (key: string): string | null => {
    const name = asked.get(key);
    return name !== null && OUTSIDE_NAME.test(name) ? name : null;
  };
  const named = (platform: External["platform"], participant: string, study: string, session: string) => {
    const name = taken(participant);
    return name ? { platform, participant: name, study: taken(study), session: taken(session) } : null;
  };
  return (
    named("prolific", "PROLIFIC_PID", "STUDY_ID", "SESSION_ID") ??
    named("mturk", "workerId", "hitId", "assignmentId") ??
    named("other", "participant", "study", "session")
  );
}

/** Takes links and outside names out of the address, where they would be seen and copied; only the language stays. */
export function cleanAddress(lang: string | null): void {
  sessionStorage.setItem(ADDRESS_KEY, location.search);
  history.replaceState(null, "", lang === null ? "/" : `/?lang=${encodeURIComponent(lang)}`);
}

/** The address by which this tab came, for a new start. */
export function firstAddress(): string {
  return `/${sessionStorage.getItem(ADDRESS_KEY) ?? location.search}`;
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
  const { source, simulate_key, link, external } = visit;
  const body = { source, simulate_key, link, external, environment };
  let session: Session;
  try {
    session = await request<Session>("/api/sessions", { body: { submission_id, ...body } });
  } catch (cause) {
    // The server has this enrolment but its answer, and with it the token, got lost on the way: enrol afresh.
    if (!(cause instanceof RequestFailed && cause.code === "duplicate_session")) throw cause;
    session = await request<Session>("/api/sessions", { body: { submission_id: crypto.randomUUID(), ...body } });
  }
  const { token, participant_id, session_id } = session;
  localStorage.setItem(keyOf(study_name), JSON.stringify({ token, participant_id, session_id }));
  return { token, participant_id, session_id };
}
