// SPDX-License-Identifier: MIT
// Requests to the study server: deadlines, the server's error form, and which failures pass by themselves.

const DEADLINE_MS = 15_000; // an answer is stored in a few ms; longer means that the line is dead

/** A request that brought no result. status 0: no answer at all (network, deadline). */
export class RequestFailed extends Error {
  constructor(
    readonly status: number,
    readonly code: string,
    message: string,
    readonly hint: string = "",
  ) {
    super(message);
    this.name = "RequestFailed";
  }

  /** True where trying again later can help and the participant need not know the cause. */
  get passes(): boolean {
    return this.status === 0 || [408, 425, 429].includes(this.status) || this.status >= 500;
  }
}

interface RequestOptions {
  token?: string | null;
  body?: unknown;
  outlives_page?: boolean;
}

/** Sends one request (POST where there is a body) and returns the parsed JSON. */
export async function request<T>(path: string, options: RequestOptions = {}): Promise<T> {
  const headers: Record<string, string> = { Accept: "application/json" };
  if (options.token) headers["Authorization"] = `Bearer ${options.token}`;
  const init: RequestInit = { headers, cache: "no-store", keepalive: options.outlives_page ?? false };
  if (options.body !== undefined) {
    init.method = "POST";
    headers["Content-Type"] = "application/json";
    init.body = JSON.stringify(options.body);
  }
  let response: Response;
  let text: string;
  try {
    response = await fetch(path, { ...init, signal: AbortSignal.timeout(DEADLINE_MS) });
    text = await response.text();
  } catch (cause) {
    throw new RequestFailed(0, "no_answer", String(cause));
  }
  if (!response.ok) throw failureOf(response.status, text);
  try {
    return JSON.parse(text) as T;
  } catch {
    throw new RequestFailed(0, "not_json", `${path} answered something other than JSON`);
  }
}

function failureOf(status: number, text: string): RequestFailed {
  try {
    const error = (JSON.parse(text) as { error?: Record<string, unknown> }).error ?? {};
    return new RequestFailed(
      status,
      String(error["code"] ?? "unknown"),
      String(error["message"] ?? `status ${status}`),
      String(error["hint"] ?? ""),
    );
  } catch {
    return new RequestFailed(status, "unknown", `status ${status}`);
  }
}
