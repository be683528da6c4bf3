# SPDX-License-Identifier: MIT
"""The texts for participants: Markdown with {title} and {contact} filled in, hashed as shown."""

from __future__ import annotations

import hashlib
import re
from dataclasses import dataclass
from pathlib import Path

from markdown_it import MarkdownIt

from verisim.study.problems import Problem

MAX_CHARS = 20_000
_WORD = re.compile(r"\{([a-z_]+)\}")
_VERSION = re.compile(r"^Version:? (\S+)$", re.MULTILINE)


@dataclass(frozen=True)
class StudyText:
    """A text as participants see it; sha256 is that of the filled-in Markdown."""

    version: str
    sha256: str
    html: str


def read_text(
    path: Path, words: dict[str, str], *, note: str | None = None
) -> tuple[StudyText | None, list[Problem]]:
    """Returns the text and what is wrong with it.

    note: makes it a consent form, which must say `Version: …`; the note goes where the form says
    {data_note}, else to its end.
    """
    if note is not None:
        words = {**words, "data_note": note}

    def fault(message: str, hint: str) -> tuple[None, list[Problem]]:
        return None, [Problem(str(path), message, hint)]

    try:
        text = path.read_text(encoding="utf-8")
    except OSError as error:
        return fault(f"cannot be read: {error.strerror}", "paths are relative to the study file")
    except UnicodeDecodeError:
        return fault("is not UTF-8 text", "save it as UTF-8")
    if not text.strip() or len(text) > MAX_CHARS:
        return fault(
            f"has {len(text)} characters; allowed: 1 to {MAX_CHARS}", "write a text of fair length"
        )
    unknown = sorted(set(_WORD.findall(text)) - set(words))
    if unknown:
        known = ", ".join(f"{{{word}}}" for word in words)
        return fault(f"unknown {{{unknown[0]}}}; allowed: {known}", "correct or remove it")
    version = _VERSION.search(text)
    if note is not None and version is None:
        return fault(
            "has no line `Version: …`", "add e.g. `Version: 1`; change it when the text changes"
        )
    if note is not None and "{data_note}" not in text:
        text += "\n{data_note}\n"
    filled = _WORD.sub(lambda match: words[match[1]], text)
    html = MarkdownIt("commonmark", {"html": False}).render(filled)
    digest = hashlib.sha256(filled.encode()).hexdigest()
    return StudyText(version[1] if version else "", digest, html), []
