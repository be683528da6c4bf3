// SPDX-License-Identifier: MIT
// What the screens share: the study, the participant's visit, the outbox, and what the server says comes next.
import { RequestFailed, request } from "./api";
import type { Log } from "./clip_evidence";
import type {
  Environment, Feedback, Next, PresentationRecord, Question, ResponseRecord, ScreenVerdict, Study, StudyEvent, Trial,
} from "./contract";
import { delivered, fetchNext, patiently } from "./delivery";
import type { Outbox } from "./outbox";
import type { ScreenReport } from "./screen_check";
import { choose, showMessage, showProgress } from "./screens";
import {
  type Session, type Visit, cleanAddress, firstAddress, forgetSession, nextEventNumber, openSession,
} from "./session";
import type { Texts } from "./texts";

const CONSENT_FIRST: Next = {
  step: "consent",
  progress: { done: 0, total: 0 },
  language: null,
  completion: null,
  withdraw_fragment: null,
  screen_problems: [],
  trial: null,
};

export class StudyPage {
  next: Next = CONSENT_FIRST;
  /** Kind of the trial before, null right after the page was loaded. */
  last_kind: Trial["trial_kind"] | null = null;
  /** What the server said of the practice answer before. */
  feedback: Feedback | null = null;
  /** The participant stopped at a rest: the trial that would follow is not shown. */
  is_stopping = false;
  private awaits_feedback = "";
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

  /** The questions that may be asked in this trial, in its order. */
  questionsOf(trial: Trial): Question[] {
    return trial.question_keys.flatMap((key) => this.study.questions.find((question) => question.key === key) ?? []);
  }

  /** Waits until everything is with the server, then asks it what comes next. */
  async advance(display: HTMLElement): Promise<void> {
    await delivered(display, this.texts, this.outbox, () => this.startOver());
    if (!this.session) return; // nobody is enrolled before they consent
    this.takeFeedback();
    this.is_stopping = false;
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
    if (!this.session) {
      this.session = await this.enrol(display, environment);
      cleanAddress(visit.lang);
    }
    await this.post("/api/consent", {
      agreed,
      form_version: study.consent.version,
      form_sha256: study.consent.sha256,
      language: study.language,
    }, "drop");
    this.has_decided = true;
  }

  /** Opens a session; where the server takes no more people, says why and stays there. */
  private async enrol(display: HTMLElement, environment: Environment): Promise<Session> {
    const { study, visit, texts } = this;
    try {
      return await patiently(display, texts, () => openSession(study.name, visit, environment, this.enrolment_id));
    } catch (cause) {
      const refusal = cause instanceof RequestFailed && cause.status === 403 && texts.refusals[cause.code];
      if (!refusal) throw cause;
      const [title, text] = refusal;
      showMessage(display, texts, { title, text });
      return new Promise(() => undefined); // there is nothing to go on to
    }
  }

  instructionsRead(): Promise<unknown> {
    return this.post("/api/instructions", {}, "drop");
  }

  /** Sends what was found out about the screen; the server judges it. */
  async sendScreen(display: HTMLElement, report: ScreenReport): Promise<ScreenVerdict | null> {
    const body = { submission_id: crypto.randomUUID(), ...report };
    const token = this.session?.token ?? null;
    try {
      return await patiently(display, this.texts, () => request<ScreenVerdict>("/api/screen", { token, body }));
    } catch (cause) {
      if (cause instanceof RequestFailed && cause.status === 409) return null; // judged already, in another tab
      throw cause;
    }
  }

  /** Keeps the answers to the questions about the whole session. */
  endAnswered(responses: ResponseRecord[]): Promise<unknown> {
    return this.post("/api/end_questions", { responses });
  }

  /** Ends the participation early, with what was answered. */
  async stop(): Promise<void> {
    await this.post("/api/stop", {}, "drop");
    this.last_kind = "test"; // what comes is no return after an interruption
  }

  /** Deletes everything of this visit, on the server and here. */
  async withdraw(display: HTMLElement): Promise<HTMLElement> {
    const body = { submission_id: crypto.randomUUID(), confirm: true };
    if (!this.session) throw new Error("nobody to withdraw");
    const { token } = this.session;
    try {
      await patiently(display, this.texts, () => request("/api/withdraw", { token, body }));
    } catch (cause) {
      // A dead token: the answer to an earlier attempt got lost on its way.
      if (!(cause instanceof RequestFailed && cause.status === 401)) throw cause;
    }
    await this.outbox.discard(token);
    forgetSession(this.study.name);
    return showMessage(display, this.texts, { title: this.texts.withdrawn_title, text: this.texts.withdrawn_text });
  }

  /** Keeps the answer of the present trial and what happened meanwhile. */
  async answered(presentation: PresentationRecord, responses: ResponseRecord[]): Promise<void> {
    const { trial_id, trial_kind, feedback } = this.trial;
    const submission_id = await this.post("/api/trials", { trial_id, presentation, responses });
    this.awaits_feedback = feedback ? submission_id : "";
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

  /** Forgets this visit and begins another by the address that led here. */
  startOver(): void {
    forgetSession(this.study.name);
    location.replace(this.study.kiosk ? "/" : firstAddress());
  }

  /** Where the study must be seen in full screen: waits until it is. */
  async returnToFullscreen(display: HTMLElement): Promise<void> {
    const { texts } = this;
    while (!document.fullscreenElement) {
      const words = { title: texts.fullscreen_back_title, text: texts.fullscreen_back_text };
      await choose(display, texts, words, [texts.go_fullscreen]);
      await document.documentElement.requestFullscreen().catch(() => undefined);
    }
  }

  private takeFeedback(): void {
    const reply = this.awaits_feedback ? this.outbox.takeReply(this.awaits_feedback) : null;
    this.awaits_feedback = "";
    this.feedback = (reply as { feedback?: Feedback | null } | null)?.feedback ?? null;
  }

  private async post(
    path: string,
    body: Record<string, unknown>,
    if_refused: "stop" | "drop" = "stop",
  ): Promise<string> {
    if (!this.session) throw new Error(`${path} before a session`);
    const submission_id = crypto.randomUUID();
    const { token } = this.session;
    await this.outbox.put({ submission_id, path, token, if_refused, body: { submission_id, ...body } });
    return submission_id;
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
