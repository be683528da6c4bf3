# SPDX-License-Identifier: MIT
"""Participant links: each holds a secret of its own, kept as a hash, good for one use or many."""

from __future__ import annotations

import secrets
from dataclasses import dataclass

from sqlalchemy import Connection, insert, select, update

from verisim.study.problems import refuse
from verisim.study.server import tables
from verisim.study.server.database import utc_now
from verisim.study.server.enrolment import hash_token
from verisim.study.server.json_text import to_json


@dataclass(frozen=True)
class Link:
    label: str
    token: str  # shown once, stored nowhere

    def address(self, base: str) -> str:
        return f"{base.rstrip('/')}/?link={self.token}"


def make_links(
    connection: Connection,
    num: int,
    label: str,
    source: str,
    max_uses: int | None,
    *,
    actor: str = "command line",
) -> list[Link]:
    """Makes links. max_uses: 1 for one person, None for any number."""
    links: list[Link] = []
    for i in range(num):
        token = secrets.token_urlsafe(32)
        name = label if num == 1 else f"{label} {i + 1}"
        connection.execute(
            insert(tables.invitation).values(
                token_sha256=hash_token(token),
                label=name,
                source=source,
                max_uses=max_uses,
                num_uses=0,
                state="open",
                created_utc=utc_now(),
            )
        )
        links.append(Link(name, token))
    detail = {"num": num, "label": label, "source": source, "max_uses": max_uses}
    connection.execute(
        insert(tables.admin_audit).values(
            at_utc=utc_now(), action="make_links", detail_json=to_json(detail), actor=actor
        )
    )
    return links


def close_links(connection: Connection, label: str, *, actor: str = "command line") -> int:
    """Closes the links of a label, one by one or the whole series; returns how many."""
    invitation = tables.invitation.c
    found = connection.scalars(
        select(invitation.invitation_id).where(
            (invitation.label == label) | invitation.label.startswith(f"{label} ", autoescape=True)
        )
    ).all()
    if not found:
        raise refuse("links", f"no link has the label {label!r}", "check its spelling")
    connection.execute(
        update(tables.invitation).where(invitation.invitation_id.in_(found)).values(state="closed")
    )
    connection.execute(
        insert(tables.admin_audit).values(
            at_utc=utc_now(),
            action="close_links",
            detail_json=to_json({"label": label, "num": len(found)}),
            actor=actor,
        )
    )
    return len(found)
