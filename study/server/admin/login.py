# SPDX-License-Identifier: MIT
"""Who may administer: accounts with Argon2 hashes, sessions in memory, a brake on guessing."""

from __future__ import annotations

import hmac
import secrets
import time
from dataclasses import dataclass, field
from pathlib import Path

from argon2 import PasswordHasher
from argon2.exceptions import InvalidHashError, VerificationError
from sqlalchemy import Connection, func, select

from verisim.study.problems import refuse
from verisim.study.server import tables
from verisim.study.server.database import insert_for, utc_now

MIN_PASSWORD_CHARS = 12
SESSION_S = 8 * 3600.0
IDLE_S = 3600.0
FREE_TRIES = 5  # wrong passwords before each further one has to wait
MAX_WAIT_S = 300.0

_hasher = PasswordHasher()
# Verified for unknown names, so that a wrong name takes as long as a wrong password.
_NOBODY = _hasher.hash(secrets.token_urlsafe(16))


def set_password(connection: Connection, name: str, password: str) -> None:
    """Creates an account or gives it another password. Raises StudyError for a weak one."""
    if not name.isidentifier() or len(name) > 40:
        raise refuse("name", f"{name!r} is not allowed", "use letters, digits and _")
    if len(password) < MIN_PASSWORD_CHARS:
        hint = f"take at least {MIN_PASSWORD_CHARS} characters, e.g. four random words"
        raise refuse("password", f"has {len(password)} characters", hint)
    row = {"name": name, "password_hash": _hasher.hash(password), "created_utc": utc_now()}
    upsert = insert_for(connection, tables.admin_account).values(row)
    connection.execute(upsert.on_conflict_do_update(index_elements=["name"], set_=row))


def has_accounts(connection: Connection) -> bool:
    return bool(connection.scalar(select(func.count()).select_from(tables.admin_account)))


def is_right(connection: Connection, name: str, password: str) -> bool:
    account = tables.admin_account.c
    stored = connection.scalar(select(account.password_hash).where(account.name == name))
    try:
        _hasher.verify(stored or _NOBODY, password)
    except (VerificationError, InvalidHashError):
        return False
    return stored is not None


@dataclass
class AdminSession:
    name: str
    csrf: str
    began: float
    seen: float


@dataclass
class Sessions:
    """Open logins, by the secret in the cookie; they end with the server."""

    open: dict[str, AdminSession] = field(default_factory=dict)

    def begin(self, name: str) -> str:
        key, now = secrets.token_urlsafe(32), time.monotonic()
        self.open[key] = AdminSession(name, secrets.token_urlsafe(32), now, now)
        return key

    def find(self, key: str) -> AdminSession | None:
        now = time.monotonic()
        for old, session in list(self.open.items()):
            if now - session.began > SESSION_S or now - session.seen > IDLE_S:
                del self.open[old]
        found = self.open.get(key)
        if found is not None:
            found.seen = now
        return found

    def end(self, key: str) -> None:
        self.open.pop(key, None)


def csrf_fits(session: AdminSession, given: str) -> bool:
    return hmac.compare_digest(session.csrf.encode(), given.encode(errors="replace"))


@dataclass
class Brake:
    """After some wrong passwords, makes each further try wait longer."""

    wrong: int = 0
    not_before: float = 0.0

    def wait_s(self) -> float:
        return max(0.0, self.not_before - time.monotonic())

    def failed(self) -> None:
        self.wrong += 1
        if self.wrong >= FREE_TRIES:
            wait = min(MAX_WAIT_S, 2.0 ** (self.wrong - FREE_TRIES))
            self.not_before = time.monotonic() + wait

    def passed(self) -> None:
        self.wrong, self.not_before = 0, 0.0


def templates() -> Path:
    return Path(__file__).parent / "templates"
