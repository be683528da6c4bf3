// SPDX-License-Identifier: MIT
// Measures the screen with a bank card: the participant makes a drawn card as wide as the real one.
import { make } from "./field";
import { focusTitle } from "./screens";
import type { Texts } from "./texts";

const CARD_MM = { width: 85.6, height: 53.98 }; // ID-1, ISO/IEC 7810
// Plainly too small on any screen, so that nobody takes the drawn size over as it stands.
const START_CSS_PX_PER_MM = (0.6 * 96) / 25.4;
const LIMITS_PX = { min: 100, max: 1000 };

/** CSS pixels per millimetre, to half a pixel of the card's width; null where the participant has no card. */
export function calibrate(display: HTMLElement, texts: Texts, can_skip: boolean): Promise<number | null> {
  return new Promise((resolve) => {
    const widest = Math.min(LIMITS_PX.max, window.innerWidth - 80);
    let width = Math.min(widest, Math.round(CARD_MM.width * START_CSS_PX_PER_MM));
    const section = make("section", "card message calibration");
    const drawn = make("div", "bank-card");
    const done = make("button", "button primary", texts.card_done);
    const edge = make("div", "card-edge");
    edge.tabIndex = 0;
    edge.setAttribute("role", "slider");
    edge.setAttribute("aria-label", texts.card_edge);
    edge.setAttribute("aria-valuemin", String(LIMITS_PX.min));
    edge.setAttribute("aria-valuemax", String(widest));
    drawn.append(edge);
    const place = make("div", "bank-card-place");
    place.append(drawn);

    const setWidth = (wish: number): void => {
      done.disabled &&= wish === width;
      width = Math.max(LIMITS_PX.min, Math.min(widest, wish));
      drawn.style.width = `${width}px`;
      drawn.style.height = `${(width * CARD_MM.height) / CARD_MM.width}px`;
      edge.setAttribute("aria-valuenow", String(width));
      edge.setAttribute("aria-valuetext", texts.cardWidth(width));
    };
    edge.addEventListener("pointerdown", (event) => {
      edge.setPointerCapture(event.pointerId);
      const start = { x: event.clientX, width };
      const drag = (move: PointerEvent): void => setWidth(start.width + move.clientX - start.x);
      edge.addEventListener("pointermove", drag);
      edge.addEventListener("pointerup", () => edge.removeEventListener("pointermove", drag), { once: true });
    });
    section.addEventListener("keydown", (event) => {
      const steps: Record<string, number> = { ArrowRight: 1, ArrowUp: 1, ArrowLeft: -1, ArrowDown: -1, PageUp: 20, PageDown: -20 };
      const step = steps[event.key];
      if (step === undefined) return;
      event.preventDefault();
      setWidth(width + step * (event.shiftKey ? 10 : 1));
    });

    const row = make("div", "buttons");
    done.disabled = true; // until the card was sized
    done.addEventListener("click", () => resolve(width / CARD_MM.width));
    row.append(done);
    if (can_skip) {
      const skip = make("button", "button", texts.card_skip);
      skip.addEventListener("click", () => resolve(null));
      row.append(skip);
    }
    section.append(make("h1", "", texts.card_title), make("p", "", texts.card_text), place, row);
    setWidth(width);
    display.replaceChildren(section);
    focusTitle(display);
  });
}
