# SPDX-License-Identifier: MIT
"""Words that questions use where the study file gives none: English and German."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from verisim.study.server.yaml_source import Section, is_text

LANGUAGE_NAMES = {"en": "English", "de": "Deutsch"}

WORDS: dict[str, dict[str, Any]] = {
    "yes": {"en": "Yes", "de": "Ja"},
    "no": {"en": "No", "de": "Nein"},
    "not_sure": {"en": "Not sure", "de": "Weiß nicht"},
    "sequential": {
        "en": ["The first clip", "The second clip"],
        "de": ["Der erste Film", "Der zweite Film"],
    },
    "side_by_side": {
        "en": ["The left clip", "The right clip"],
        "de": ["Der linke Film", "Der rechte Film"],
    },
    "kept": {"en": "kept", "de": "eingehalten"},
    "violated": {"en": "violated", "de": "verletzt"},
    "cannot_tell": {"en": "cannot tell", "de": "kann ich nicht sagen"},
    "none": {"en": "I saw nothing wrong", "de": "Mir fiel nichts Falsches auf"},
    "fun_prompt": {
        "en": "How much fun was this clip to watch?",
        "de": "Wie viel Spaß hat dieser Film gemacht?",
    },
    "fun_ends": {"en": ["none at all", "a great deal"], "de": ["gar keinen", "sehr viel"]},
    "confidence_prompt": {
        "en": "How sure are you of your answer?",
        "de": "Wie sicher sind Sie sich?",
    },
    "confidence_ends": {"en": ["guessing", "certain"], "de": ["geraten", "ganz sicher"]},
    "emotion_prompt": {
        "en": "While watching this clip, I felt …",
        "de": "Beim Ansehen dieses Films war ich …",
    },
    "emotion_ends": {"en": ["not at all", "very much"], "de": ["gar nicht", "sehr"]},
}


def language_name(language: str) -> str:
    return LANGUAGE_NAMES.get(language, language)


def read_words(
    section: Section,
    key: str,
    languages: Sequence[str],
    default: str | None,
    *,
    max_chars: int = 60,
) -> dict[str, str]:
    """Takes one text per language; without the key, the default words if they exist."""
    if default is not None and not section.has(key):
        return default_words(section, key, languages, default)
    allowed = f"a text of at most {max_chars} characters"
    return section.localized(key, languages, allowed, lambda v: is_text(v, max_chars))


def default_words(
    section: Section, key: str, languages: Sequence[str], default: str
) -> dict[str, Any]:
    section.taken.append(key)
    known = WORDS[default]
    missing = [language for language in languages if language not in known]
    if missing:
        section.complain(
            key, f"missing; there are no words of our own in {', '.join(missing)}", f"add `{key}:`"
        )
    return {language: known[language] for language in languages if language in known}


def read_pair(
    section: Section, key: str, languages: Sequence[str], default: str | None
) -> dict[str, list[str]]:
    """Takes two texts per language, e.g. the two ends of a scale."""
    if default is not None and not section.has(key):
        return default_words(section, key, languages, default)

    def accept(value: Any) -> bool:
        return isinstance(value, list) and len(value) == 2 and all(is_text(v, 60) for v in value)

    return section.localized(key, languages, "two texts, e.g. [low end, high end]", accept)


def read_named(
    section: Section, key: str, languages: Sequence[str], low: int, high: int
) -> dict[str, dict[str, str]]:
    """Takes `{code: {en: words, …}, …}` with `low` to `high` codes; returns it."""
    inner = section.section(key)
    if not section.has(key):
        return {}
    if not low <= len(inner.value) <= high:
        section.complain(key, f"has {len(inner.value)} entries; allowed: {low} to {high}")
    named: dict[str, dict[str, str]] = {}
    for code in inner.value:
        inner.taken.append(code)
        if not _is_code(code):
            inner.complain(code, f"{code!r} is not allowed as a code", "use a-z, 0-9 and _")
            continue
        words = Section(section.source, inner.value[code], (*inner.at, code))
        named[code] = {
            language: words.take(language, "a text of at most 60 characters", _is_short)
            for language in languages
        }
        words.finish()
    return named


def _is_short(value: Any) -> bool:
    return is_text(value, 60)


def _is_code(code: str) -> bool:
    plain = code.replace("_", "")
    return 0 < len(code) <= 40 and code.isascii() and code[0].isalpha() and plain.isalnum()
