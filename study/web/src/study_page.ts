// SPDX-License-Identifier: MIT
// What the screens share: the study, the participant's visit, the outbox, and what the server says comes next.
import { RequestFailed } from "./api";
import type { Clip, Environment, Next, PresentationRecord, ResponseRecord, Study, StudyEvent, Trial } from "./contract";
import { delivered, fetchNext, patiently } from "./delivery";
import type { Outbox } from "./outbox";
import type { Log } from "./presentation";
import { showMessage, showProgress } from "./screens";
import { type Session, type Visit, forgetSession, nextEventNumber, openSession } from "./session";
import type { Texts } from "./texts";

const CONSENT_FIRST: Next = {
  step: "consent",
  progress: { done: 0, total: 0 },
  completion_code: null,
  trial: null,
};

export class StudyPage {
  next: Next = CONSENT_FIRST;
  /** Kind of the trial before, null right after the page was loaded. */
  last_kind: Trial["trial_kind"] | null = null;
  private events: StudyEvent[] = [];
  private has_decided = false;
  private readonly enrolment_id = crypto.randomUUID();

  constructor(
    readonly study: Study,
    readonly texts: Texts,
    readonly visit: Visit,
    private readonly environment: Promise<Environment>,
    private readonly outbox: Outbox,
    private session: Session | null,
  ) {}

  get trial(): Trial {
    if (!this.next.trial) throw new Error("the server named no trial");
    return this.next.trial;
  }

  get clip(): Clip {
    const [clip] = this.trial.clips;
    if (!clip || this.trial.layout !== "single") {
      throw new Error(`layout "${this.trial.layout}" with ${this.trial.clips.length} clips; this page shows "single"`);
    }
    return clip;
  }

  /** Waits until everything is with the server, then asks it what comes next. */
  async advance(display: HTMLElement): Promise<void> {
    await delivered(display, this.texts, this.outbox, () => this.startOver());
    if (!this.session) return; // nobody is enrolled before they consent
    try {
      this.next = await fetchNext(display, this.texts, this.session.token);
    } catch (cause) {
      if (!(cause instanceof RequestFailed && cause.status === 401)) throw cause;
      await this.showSessionLost(display);
    }
    // Decided, and asked again: the form has changed meanwhile, and the new one must be read.
    if (this.has_decided && this.next.step === "consent") location.reload();
    showProgress(this.next.progress.done, this.next.progress.total, this.texts);
  }

  /** Enrols the participant and keeps their decision. Nothing about them is sent before they decide. */
  async decide(display: HTMLElement, agreed: boolean): Promise<void> {
    const { study, visit } = this;
    const environment = await this.environment;
    this.session ??= await patiently(display, this.texts, () =>
      openSession(study.name, visit, environment, this.enrolment_id),
    );
    await this.post("/api/consent", {
      agreed,
      form_version: study.consent.version,
      form_sha256: study.consent.sha256,
      language: study.language,
    }, "drop");
    this.has_decided = true;
  }

  instructionsRead(): Promise<void> {
    return this.post("/api/instructions", {}, "drop");
  }

  /** Keeps the answer of the present trial and what happened meanwhile. */
  async answered(presentation: PresentationRecord, responses: ResponseRecord[]): Promise<void> {
    const { trial_id, trial_kind } = this.trial;
    await this.post("/api/trials", { trial_id, presentation, responses });
    this.last_kind = trial_kind;
    while (this.events.length) await this.post("/api/events", { events: this.events.splice(0, 200) }, "drop");
  }

  /** Best effort: the page may be gone before an answer comes. */
  reportBrokenOff(presentation: PresentationRecord): void {
    const body = { submission_id: crypto.randomUUID(), trial_id: this.trial.trial_id, presentation };
    void fetch("/api/presentations", {
      method: "POST",
      keepalive: true,
      headers: { "Content-Type": "application/json", Authorization: `Bearer ${this.session?.token}` },
      body: JSON.stringify(body),
    }).catch(() => undefined);
  }

  readonly log: Log = (kind, presentation_id, detail) => {
    if (!this.session) return;
    const seq = nextEventNumber(this.session);
    const short = Object.entries(detail).map(([key, it]) => [key, typeof it === "string" ? it.slice(0, 300) : it]);
    this.events.push({ seq, presentation_id, kind, t_ms: performance.now(), detail: Object.fromEntries(short) });
  };

  startOver(): void {
    forgetSession(this.study.name);
    location.reload();
  }

  private async post(path: string, body: Record<string, unknown>, if_refused: "stop" | "drop" = "stop"): Promise<void> {
    if (!this.session) throw new Error(`${path} before a session`);
    const submission_id = crypto.randomUUID();
    const { token } = this.session;
    await this.outbox.put({ submission_id, path, token, if_refused, body: { submission_id, ...body } });
  }

  private showSessionLost(display: HTMLElement): Promise<never> {
    const { texts } = this;
    return new Promise(() => {
      showMessage(display, texts, {
        title: texts.session_lost_title,
        text: texts.session_lost_text,
        choices: [{ label: texts.start_over, is_primary: true, onPress: () => this.startOver() }],
      });
    });
  }
}
