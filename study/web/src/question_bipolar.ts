// SPDX-License-Identifier: MIT
// Bipolar rating: the middle point is "just right", the ends are too little and too much.
import type { MakeField } from "./field";
import { makePoints } from "./question_rating";

export const makeBipolar: MakeField = (question, context) => {
  const middle = question.labels?.[Math.floor((question.points ?? 7) / 2)];
  return makePoints(question, context, middle || null);
};
