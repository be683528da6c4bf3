// SPDX-License-Identifier: MIT
// The kinds of question this page can ask. A new kind is one file and one line here.
import type { QuestionKind } from "./contract";
import type { MakeField } from "./field";
import { makeBipolar } from "./question_bipolar";
import { makeComment } from "./question_comment";
import { makeRating } from "./question_rating";
import { makeSlider } from "./question_slider";

export const MAKE_FIELD: Record<QuestionKind, MakeField> = {
  rating: makeRating,
  bipolar: makeBipolar,
  slider: makeSlider,
  comment: makeComment,
};
