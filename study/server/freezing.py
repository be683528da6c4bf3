# SPDX-License-Identifier: MIT
"""Fixes a study before its first participant: hashes of file, texts, clips, protocol and rules."""

from __future__ import annotations

import hashlib
import json
from pathlib import Path
from typing import Any

from sqlalchemy import Connection, insert, select, update

from verisim.study.problems import refuse
from verisim.study.server import tables
from verisim.study.server.database import utc_now
from verisim.study.server.design import check_design, load_both
from verisim.study.server.json_text import to_json
from verisim.study.server.stimulus_set import StimulusSet, file_sha256
from verisim.study.server.study_file import Study

SCHEMA = 1


def frozen_path(study_path: Path) -> Path:
    return study_path.with_suffix(".frozen.json")


def fingerprints(study: Study, clips: StimulusSet, protocol: Path | None) -> dict[str, str]:
    """Returns the sha256 of each thing that is fixed, by name."""
    hashes = {
        "study file": file_sha256(study.path),
        "study and texts": study.config_sha256(),
        "exclusion rules": _sha256(to_json(study.exclude.rules())),
        "manifest": file_sha256(clips.directory / "manifest.csv"),
        "clips": clips.sha256,
    }
    if protocol is not None:
        hashes["protocol"] = file_sha256(protocol)
    return hashes


def freeze(
    study_path: Path, set_dir: Path, protocol: Path | None = None, *, reason: str | None = None
) -> Path:
    """Writes STUDY.frozen.json and returns its path.

    A study that is frozen already is frozen again only with a reason, which stays in the file
    together with what changed. Raises StudyError for a study that cannot be carried out.
    """
    study, clips = load_both(study_path, set_dir)
    check_design(study, clips)
    if protocol is not None and not protocol.is_file():
        raise refuse(protocol, "no such file", "give the --protocol FILE that is registered")
    path = frozen_path(study_path)
    deviations: list[dict[str, Any]] = []
    hashes = fingerprints(study, clips, protocol)
    now = utc_now()
    if path.exists():
        before = read_frozen(path)
        changes = differences(before["sha256"], hashes)
        if not changes:
            return path
        if not reason:
            names = ", ".join(change["what"] for change in changes)
            raise refuse(
                path, f"is frozen already; changed since: {names}", "say why with --again REASON"
            )
        deviations = [*before["deviations"]]
        deviations += [{"at_utc": now, "reason": reason, **change} for change in changes]
    document = {
        "schema": SCHEMA,
        "study": study.name,
        "frozen_utc": now,
        "protocol": str(protocol) if protocol else None,
        "sha256": hashes,
        "clip_sha256": {s.name: s.sha256 for s in sorted(clips.stimuli, key=lambda s: s.name)},
        "deviations": deviations,
    }
    text = json.dumps(document, ensure_ascii=False, indent=2) + "\n"
    path.write_text(text, encoding="utf-8")
    return path


def read_frozen(path: Path) -> dict[str, Any]:
    try:
        document = json.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise refuse(
            path, "the study is not frozen", "fix it first: `verisim study freeze STUDY`"
        ) from error
    except ValueError as error:
        raise refuse(path, f"cannot be read: {error}", "freeze the study again") from error
    if not isinstance(document, dict) or document.get("schema") != SCHEMA:
        raise refuse(path, "is not what `verisim study freeze` writes", "freeze the study again")
    return document


def differences(before: dict[str, str], after: dict[str, str]) -> list[dict[str, str]]:
    return [
        {"what": what, "frozen": before.get(what, ""), "seen": after.get(what, "")}
        for what in sorted({*before, *after})
        if before.get(what) != after.get(what)
    ]


def check_frozen(connection: Connection, study: Study, clips: StimulusSet) -> str | None:
    """Compares a live study with what was frozen; logs each difference in the database.

    Returns the message of a refusal, None where all is as it was frozen. A study that was frozen
    again with a reason goes on; each change is logged as accepted, once.
    """
    frozen = read_frozen(frozen_path(study.path))
    protocol = Path(frozen["protocol"]) if frozen["protocol"] else None
    if protocol is not None and not protocol.is_file():
        return f"the frozen protocol {protocol} is missing"
    changes = differences(frozen["sha256"], fingerprints(study, clips, protocol))
    log_deviations(connection, changes, "refused")
    if changes:
        return "changed since it was frozen: " + ", ".join(c["what"] for c in changes)
    stored = connection.scalar(select(tables.study.c.frozen_json))
    known = json.loads(stored)["deviations"] if stored else []
    for deviation in frozen["deviations"][len(known) :] if stored else []:
        log_deviations(connection, [deviation], f"accepted: {deviation['reason']}")
    connection.execute(update(tables.study).values(frozen_json=to_json(frozen)))
    return None


def log_deviations(connection: Connection, changes: list[dict[str, str]], outcome: str) -> None:
    for change in changes:
        connection.execute(
            insert(tables.deviation).values(
                at_utc=utc_now(),
                what=change["what"],
                frozen_sha256=change["frozen"],
                seen_sha256=change["seen"],
                outcome=outcome,
            )
        )


def _sha256(text: str) -> str:
    return hashlib.sha256(text.encode()).hexdigest()
