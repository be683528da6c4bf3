// SPDX-License-Identifier: MIT
// What is known of the device, for the session's row: browser, screen, refresh rate. No fingerprinting beyond these.
import type { Environment } from "./contract";

declare const APP_VERSION: string;

// Most specific first: Edge and Opera also say Chrome, Chrome also says Safari.
const BROWSERS: [name: string, pattern: RegExp][] = [
  ["Edge", /Edg(?:e|A|iOS)?\/([\d.]+)/],
  ["Opera", /OPR\/([\d.]+)/],
  ["Samsung Internet", /SamsungBrowser\/([\d.]+)/],
  ["Firefox", /(?:Firefox|FxiOS)\/([\d.]+)/],
  ["Chrome", /(?:Chrome|CriOS)\/([\d.]+)/],
  ["Safari", /Version\/([\d.]+).*Safari/],
];

const SYSTEMS: [name: string, pattern: RegExp][] = [
  ["Android", /Android/],
  ["iOS", /iPhone|iPad|iPod/],
  ["Windows", /Windows/],
  ["macOS", /Mac OS X/],
  ["ChromeOS", /CrOS/],
  ["Linux", /Linux/],
];

export function browserOf(user_agent: string): { browser: string; browser_version: string } {
  for (const [browser, pattern] of BROWSERS) {
    const found = pattern.exec(user_agent);
    if (found) return { browser, browser_version: found[1] ?? "" };
  }
  return { browser: "other", browser_version: "" };
}

export async function measureEnvironment(num_frames = 40): Promise<Environment> {
  const agent = navigator.userAgent;
  return {
    ...browserOf(agent),
    os: SYSTEMS.find(([, pattern]) => pattern.test(agent))?.[0] ?? "other",
    is_mobile: /Mobi|Android|iPhone|iPad/.test(agent),
    screen_w: screen.width,
    screen_h: screen.height,
    viewport_w: window.innerWidth,
    viewport_h: window.innerHeight,
    device_pixel_ratio: window.devicePixelRatio,
    refresh_hz: await refreshHz(num_frames),
    language: navigator.language,
    tz_offset_min: -new Date().getTimezoneOffset(), // minutes east of UTC
    app_version: APP_VERSION,
  };
}

/** Refresh rate of the screen from the median of `num_frames` frame times; null where no frames come (out of sight). */
export async function refreshHz(num_frames = 40): Promise<number | null> {
  const times: number[] = [];
  const measured = new Promise<void>((resolve) => {
    const tick = (now: number): void => {
      times.push(now);
      if (times.length > num_frames) resolve();
      else requestAnimationFrame(tick);
    };
    requestAnimationFrame(tick);
  });
  await Promise.race([measured, new Promise((resolve) => setTimeout(resolve, 40 * num_frames))]);
  const steps = times.slice(1).map((time, i) => time - (times[i] ?? time));
  steps.sort((a, b) => a - b);
  const median = steps[Math.floor(steps.length / 2)];
  return median && median > 0 ? Math.round(10_000 / median) / 10 : null;
}
