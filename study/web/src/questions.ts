// SPDX-License-Identifier: MIT
// The kinds of question this page can ask. A new kind is one line here, and one file where it needs a new control.
import type { QuestionKind } from "./contract";
import type { MakeField } from "./field";
import { makeComment } from "./question_comment";
import { makeChecklist, makeEmotion } from "./question_grid";
import { makeMark } from "./question_mark";
import { makeChoice, makeOptions } from "./question_options";
import { makeRating } from "./question_rating";
import { makeSlider } from "./question_slider";

export const MAKE_FIELD: Record<QuestionKind, MakeField> = {
  rating: makeRating,
  bipolar: makeRating, // its middle point has a name: just right
  fun: makeRating, // no faces: they would say what to answer
  confidence: makeRating,
  slider: makeSlider,
  yes_no: makeOptions,
  category: makeOptions,
  choice: makeChoice,
  checklist: makeChecklist,
  emotion: makeEmotion,
  comment: makeComment,
  mark: makeMark,
};
