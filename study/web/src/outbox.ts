// SPDX-License-Identifier: MIT
// Keeps every answer in the browser's database until the server has acknowledged it.
//
// A letter is written with strict durability before the page moves on, delivered in order, and deleted only when the
// server says that it has it (201, or 200 for a repeat) or that the first answer stands (409). It therefore survives a
// dead server, a closed tab and a crash of the browser; the server drops repeats by their submission_id.
import { RequestFailed, request } from "./api";
import { pause, waitMs } from "./back_off";

export interface Letter {
  submission_id: string;
  path: string;
  token: string;
  body: Record<string, unknown>;
  /** What a refusal (4xx) means: an answer must be rescued by a person, a log entry may be lost. */
  if_refused: "stop" | "drop";
  written_at: string;
}

type StoredLetter = Letter & { number: number };

export type OutboxState =
  | { kind: "empty" }
  | { kind: "sending" }
  | { kind: "waiting"; num_failures: number }
  | { kind: "refused"; failure: RequestFailed };

const STORE = "letters";

export class Outbox {
  state: OutboxState = { kind: "empty" };
  private readonly listeners = new Set<(state: OutboxState) => void>();
  private readonly replies = new Map<string, unknown>();
  private is_delivering = false;
  private has_news = false;

  private constructor(private readonly db: IDBDatabase) {}

  /** Opens the outbox of one study. Throws where the browser keeps no data (some private windows). */
  static async open(study_name: string): Promise<Outbox> {
    const opening = indexedDB.open(`verisim outbox ${study_name}`, 1);
    opening.onupgradeneeded = () => {
      opening.result.createObjectStore(STORE, { keyPath: "number", autoIncrement: true });
    };
    return new Outbox(await settled(opening));
  }

  /** Resolves when the letter is on the disk of this device; delivery starts by itself. */
  async put(letter: Omit<Letter, "written_at">): Promise<void> {
    const writing = this.db.transaction(STORE, "readwrite", { durability: "strict" });
    writing.objectStore(STORE).add({ ...letter, written_at: new Date().toISOString() });
    await committed(writing);
    this.deliver();
  }

  /** The server's reply to a letter delivered since the page was loaded; null where there is none. To be asked once. */
  takeReply(submission_id: string): unknown {
    const reply = this.replies.get(submission_id) ?? null;
    this.replies.clear();
    return reply;
  }

  letters(): Promise<StoredLetter[]> {
    return settled(this.db.transaction(STORE).objectStore(STORE).getAll()) as Promise<StoredLetter[]>;
  }

  /** Calls `listener` now and at every change of state; returns the function that ends this. */
  watch(listener: (state: OutboxState) => void): () => void {
    this.listeners.add(listener);
    listener(this.state);
    return () => void this.listeners.delete(listener);
  }

  /** Resolves when nothing is left to deliver; throws the server's refusal. */
  async emptied(): Promise<void> {
    this.deliver();
    await new Promise<void>((resolve, reject) => {
      const stop = this.watch((state) => {
        if (state.kind === "empty") resolve();
        else if (state.kind === "refused") reject(state.failure);
        else return;
        queueMicrotask(() => stop());
      });
    });
  }

  /** Deletes what one visit could not deliver. Only for a visit that the server no longer knows. */
  async discard(token: string): Promise<void> {
    const letters = await this.letters();
    const clearing = this.db.transaction(STORE, "readwrite");
    for (const letter of letters) if (letter.token === token) clearing.objectStore(STORE).delete(letter.number);
    await committed(clearing);
    if (letters.every((letter) => letter.token === token)) this.become({ kind: "empty" });
  }

  private deliver(): void {
    this.has_news = true;
    if (this.is_delivering) return;
    this.is_delivering = true;
    this.become({ kind: "sending" });
    void this.deliverNews().then((state) => {
      this.is_delivering = false;
      this.become(state);
    });
  }

  private async deliverNews(): Promise<OutboxState> {
    let state: OutboxState = { kind: "empty" };
    try {
      // A letter can arrive while the last look finds nothing: look again.
      while (this.has_news && state.kind === "empty") {
        this.has_news = false;
        state = await this.deliverAll();
      }
    } catch (cause) {
      state = { kind: "refused", failure: new RequestFailed(0, "browser_storage", String(cause)) };
    }
    return state;
  }

  private async deliverAll(): Promise<OutboxState> {
    let num_failures = 0;
    for (;;) {
      const [letter] = await this.letters();
      if (!letter) return { kind: "empty" };
      try {
        const reply = await request(letter.path, { token: letter.token, body: letter.body });
        if (letter.path === "/api/trials") this.replies.set(letter.submission_id, reply);
      } catch (cause) {
        const failure = cause as RequestFailed;
        if (failure.passes) {
          num_failures += 1;
          this.become({ kind: "waiting", num_failures });
          await pause(waitMs(num_failures));
          continue;
        }
        const has_it = failure.status === 409 && failure.code !== "out_of_order";
        if (!has_it && letter.if_refused === "stop") return { kind: "refused", failure };
      }
      num_failures = 0;
      const deleting = this.db.transaction(STORE, "readwrite");
      deleting.objectStore(STORE).delete(letter.number);
      await committed(deleting);
    }
  }

  private become(state: OutboxState): void {
    this.state = state;
    for (const listener of [...this.listeners]) listener(state);
  }
}

function settled<T>(wish: IDBRequest<T>): Promise<T> {
  return new Promise((resolve, reject) => {
    wish.onsuccess = () => resolve(wish.result);
    wish.onerror = () => reject(wish.error);
  });
}

function committed(transaction: IDBTransaction): Promise<void> {
  return new Promise((resolve, reject) => {
    transaction.oncomplete = () => resolve();
    transaction.onabort = () => reject(transaction.error);
    transaction.onerror = () => reject(transaction.error);
  });
}
