// SPDX-License-Identifier: MIT
// Finds out whether this screen can show the study: full screen, size, calibration with a card, distance, codec, refresh.
import { calibrate } from "./calibration";
import { probeCodec } from "./codec_probe";
import type { Environment, ScreenRules } from "./contract";
import { askDistance } from "./distance";
import { measureEnvironment } from "./environment";
import { choose, showMessage } from "./screens";
import type { StudyPage } from "./study_page";
import type { Texts } from "./texts";

const NUM_FRAMES = 120; // two seconds at 60 Hz

export interface ScreenReport {
  environment: Environment;
  codec_plays: boolean | null;
  fullscreen: boolean;
  refresh_hz: number | null;
  css_px_per_mm: number | null;
  viewing_distance_mm: number | null;
  calibration_skipped: boolean;
}

/** Goes through all checks that the study asks for, again where the server finds something that can be put right. */
export async function checkScreen(display: HTMLElement, study_page: StudyPage): Promise<void> {
  const { texts, study } = study_page;
  const rules = study.screen;
  if (!rules) throw new Error("the server asks for a screen check without rules");
  const size = { css_px_per_mm: null as number | null, distance_mm: null as number | null, was_skipped: false };
  let todo = new Set(["fullscreen", "viewport", "calibration", "distance"]);
  for (;;) {
    if (todo.has("fullscreen") && rules.fullscreen !== "off") await offerFullscreen(display, texts, rules);
    await waitForRoom(display, texts, rules);
    if (rules.calibration !== "off" && (todo.has("calibration") || todo.has("px_per_degree"))) {
      size.css_px_per_mm = await calibrate(display, texts, rules.calibration === "offer");
      size.was_skipped = size.css_px_per_mm === null;
    }
    const { distance_mm } = rules;
    if (distance_mm && (todo.has("distance") || todo.has("px_per_degree"))) {
      size.distance_mm = await askDistance(display, texts, distance_mm);
    }
    showMessage(display, texts, { title: texts.checking_title, text: texts.checking_text });
    const codec_plays = rules.codec && (await probeCodec(rules.codec.mime, rules.codec.probe, display));
    const environment = await measureEnvironment(NUM_FRAMES);
    const verdict = await study_page.sendScreen(display, {
      environment,
      codec_plays,
      fullscreen: document.fullscreenElement !== null,
      refresh_hz: environment.refresh_hz,
      css_px_per_mm: size.css_px_per_mm,
      viewing_distance_mm: size.distance_mm,
      calibration_skipped: size.was_skipped,
    });
    if (verdict?.verdict !== "refused") return;
    const refused = verdict.problems.filter(({ code }) => code !== "refresh" || rules.refresh === "refuse");
    if (refused.some(({ fixable }) => !fixable)) return; // the server ends the visit here
    const codes = refused.map(({ code }) => code);
    const text = codes.map((code) => texts.screen_problems[code] ?? code).join(" ");
    await choose(display, texts, { title: texts.screen_title, text }, [texts.try_again]);
    todo = new Set(codes);
  }
}

async function offerFullscreen(display: HTMLElement, texts: Texts, rules: ScreenRules): Promise<void> {
  if (document.fullscreenElement || !document.fullscreenEnabled) return;
  const is_needed = rules.fullscreen === "require";
  const words = { title: texts.fullscreen_title, text: is_needed ? texts.fullscreen_needed : texts.fullscreen_text };
  const labels = is_needed ? [texts.go_fullscreen] : [texts.go_fullscreen, texts.stay_in_window];
  if ((await choose(display, texts, words, labels)) === 0) {
    await document.documentElement.requestFullscreen().catch(() => undefined); // the server judges what came of it
    await new Promise((resolve) => setTimeout(resolve, 300)); // the window takes its new size
  }
}

/** CSS pixels that the window needs: a device pixel for each of the clips', or what the study asks for beyond that. */
export function neededRoom({ min_viewport, clip_px }: ScreenRules, pixel_ratio: number): [number, number] {
  const least = min_viewport ?? [0, 0];
  const [width, height] = clip_px.map((px) => Math.ceil(px / pixel_ratio)) as [number, number];
  return [Math.max(least[0], width), Math.max(least[1], height)];
}

async function waitForRoom(display: HTMLElement, texts: Texts, rules: ScreenRules): Promise<void> {
  for (;;) {
    const [width, height] = neededRoom(rules, window.devicePixelRatio);
    if (window.innerWidth >= width && window.innerHeight >= height) return;
    const text = texts.viewportText(width, height, window.innerWidth, window.innerHeight);
    const labels = [texts.check_again];
    if (document.fullscreenEnabled && !document.fullscreenElement) labels.push(texts.go_fullscreen);
    if ((await choose(display, texts, { title: texts.viewport_title, text }, labels)) === 1) {
      await document.documentElement.requestFullscreen().catch(() => undefined);
      await new Promise((resolve) => setTimeout(resolve, 300));
    }
  }
}
