# SPDX-License-Identifier: MIT
"""The administration interface: plain forms, each checked for login and origin, and logged."""

from __future__ import annotations

import asyncio
import io
import re
import tempfile
import zipfile
from collections.abc import Awaitable, Callable
from http.cookies import SimpleCookie
from pathlib import Path
from typing import Any
from urllib.parse import parse_qsl

from fastapi import FastAPI, Request
from fastapi.responses import HTMLResponse, RedirectResponse, Response
from jinja2 import Environment, FileSystemLoader, StrictUndefined
from sqlalchemy import Connection, insert, update
from starlette.types import ASGIApp

from verisim.study.export import export
from verisim.study.problems import StudyError
from verisim.study.server import tables
from verisim.study.server.admin.figures import read_figures
from verisim.study.server.admin.login import (
    AdminSession,
    Brake,
    Sessions,
    csrf_fits,
    is_right,
    templates,
)
from verisim.study.server.app import Serving
from verisim.study.server.database import Place, checkpoint, utc_now
from verisim.study.server.guard import Guard
from verisim.study.server.json_text import to_json
from verisim.study.server.redaction import redact_comment, redact_remark
from verisim.study.server.withdrawal import erase, find_participant, purge_outside_ids

COOKIE = "verisim_admin"
STATES = ("open", "paused", "closed")
Form = dict[str, str]
# What a form does: (session, form) → notice for the page, or a response of its own.
Action = Callable[[AdminSession, Form], Awaitable[str | Response]]


def create_admin_app(serving: Serving, hosts: tuple[str, ...]) -> ASGIApp:
    """Returns the application. hosts: what the Host header may say, so that no foreign name
    that points here can reach it."""
    admin = Admin(serving)
    app = FastAPI(docs_url=None, redoc_url=None, openapi_url=None)

    @app.get("/")
    def overview(request: Request) -> Response:
        session = admin.session_of(request)
        if session is None:
            return admin.page("login.html", title=admin.title, error="")
        return admin.overview(session, renewed=True)

    @app.get("/still")
    def still(request: Request) -> Response:
        """The same page, which stays as it is while somebody types."""
        session = admin.session_of(request)
        return RedirectResponse("/", 303) if session is None else admin.overview(session)

    @app.post("/login")
    async def login(request: Request) -> Response:
        return await admin.log_in(await read_form(request))

    def add_action(name: str, act: Action) -> None:
        @app.post(f"/{name}", name=name)
        async def post(request: Request) -> Response:
            session = admin.session_of(request)
            if session is None:
                return RedirectResponse("/", 303)
            form = await read_form(request)
            if not csrf_fits(session, form.get("csrf", "")):
                return Response("This form is out of date. Go back and load the page anew.", 403)
            done = await act(session, form)
            return done if isinstance(done, Response) else admin.overview(session, done)

    add_action("state", admin.set_state)
    add_action("erase", admin.erase)
    add_action("redact", admin.redact)
    add_action("forget", admin.forget)
    add_action("export", admin.export)

    @app.post("/logout")
    async def logout(request: Request) -> Response:
        session = admin.session_of(request)
        form = await read_form(request)
        if session is not None and csrf_fits(session, form.get("csrf", "")):
            admin.sessions.end(cookie_of(request))
        response = RedirectResponse("/", 303)
        response.delete_cookie(COOKIE)
        return response

    return Guard(HostCheck(app, hosts), forms=True)


class HostCheck:
    """Answers only to its own name."""

    def __init__(self, app: ASGIApp, hosts: tuple[str, ...]) -> None:
        self._app = app
        self._hosts = {host.encode() for host in hosts}

    async def __call__(self, scope: Any, receive: Any, send: Any) -> None:
        if scope["type"] == "http":
            named = dict(scope["headers"]).get(b"host", b"")
            if named not in self._hosts:
                await Response("not here", 421)(scope, receive, send)
                return
        await self._app(scope, receive, send)


class Admin:
    """The work behind the routes."""

    def __init__(self, serving: Serving) -> None:
        self._serving = serving
        self.sessions = Sessions()
        self._brake = Brake()
        loader = FileSystemLoader(templates())
        self._pages = Environment(loader=loader, autoescape=True, undefined=StrictUndefined)
        self._pages.filters["when"] = lambda utc: utc[:19].replace("T", " ")
        self.title = f"Administration: {serving.opened.study.name}"

    def page(self, name: str, status: int = 200, **words: Any) -> HTMLResponse:
        html = self._pages.get_template(name).render({"refresh": False, **words})
        return HTMLResponse(html, status)

    def session_of(self, request: Request) -> AdminSession | None:
        return self.sessions.find(cookie_of(request))

    def overview(
        self, session: AdminSession, notice: str = "", *, renewed: bool = False
    ) -> Response:
        with self._serving.reader.begin() as connection:
            figures = read_figures(connection, self._serving.opened, self._serving.mode)
        return self.page(
            "overview.html",
            title=self.title,
            f=figures,
            csrf=session.csrf,
            notice=notice,
            refresh=renewed,
        )

    async def log_in(self, form: Form) -> Response:
        if self._brake.wait_s() > 0:
            error = "Too many wrong passwords. Wait a moment and try again."
            return self.page("login.html", 429, title=self.title, error=error)

        def check() -> bool:
            with self._serving.reader.begin() as connection:
                return is_right(connection, form.get("name", ""), form.get("password", ""))

        if not await asyncio.to_thread(check):
            self._brake.failed()
            await self._log("unknown", "login_failed", {})
            error = "Name or password is wrong."
            return self.page("login.html", 401, title=self.title, error=error)
        self._brake.passed()
        await self._log(form["name"], "login", {})
        response = RedirectResponse("/", 303)
        key = self.sessions.begin(form["name"])
        response.set_cookie(COOKIE, key, httponly=True, samesite="strict")
        return response

    async def set_state(self, session: AdminSession, form: Form) -> str:
        state = form.get("state", "")
        if state not in STATES:
            return f"{state!r} is not allowed; allowed: {', '.join(STATES)}"

        def work(connection: Connection) -> None:
            connection.execute(update(tables.study).values(state=state))
            audit(connection, session.name, "set_state", {"state": state})

        await self._write(work)
        return f"The study is {state} now."

    async def erase(self, session: AdminSession, form: Form) -> str:
        named, reason = form.get("participant", "").strip(), form.get("reason", "").strip()[:200]
        if form.get("sure") != "1" or not reason:
            return "Nothing was deleted: tick the box and give a reason."

        def work(connection: Connection) -> int | None:
            participant_id = find_participant(connection, named)
            if participant_id is None:
                return None
            return erase(connection, participant_id, reason=reason, actor=session.name)

        num = await self._write(work)
        if num is None:
            return "Nobody has this code or identifier."
        await asyncio.to_thread(checkpoint, self._serving.db)
        return f"Deleted, {num} answers with it."

    async def redact(self, session: AdminSession, form: Form) -> str:
        redact = {"comment": redact_comment, "remark": redact_remark}.get(form.get("what", ""))
        number, reason = form.get("number", ""), form.get("reason", "").strip()[:200]
        if not reason:
            return "Nothing was redacted: give a reason."
        if redact is None or not re.fullmatch(r"[0-9]{1,15}", number):
            return "Nothing was redacted: no such text."
        done = await self._write(
            lambda c: redact(c, int(number), reason=reason, actor=session.name)
        )
        if not done:
            return "Nothing was redacted: there is no such text, or its words are gone already."
        await asyncio.to_thread(checkpoint, self._serving.db)
        return "Redacted: its words are gone from the database; copies made before still hold them."

    async def forget(self, session: AdminSession, form: Form) -> str:
        del form
        num = await self._write(lambda c: purge_outside_ids(c, actor=session.name))
        await asyncio.to_thread(checkpoint, self._serving.db)
        return f"{num} outside identifiers were deleted."

    async def export(self, session: AdminSession, form: Form) -> str | Response:
        blind = form.get("blind") == "1"
        name = f"{self._serving.opened.study.name}-export"
        try:
            content = await asyncio.to_thread(zip_export, self._serving.db, name, blind)
        except StudyError as error:
            return str(error)
        await self._log(session.name, "export", {"blind": blind})
        disposition = f'attachment; filename="{name}.zip"'
        headers = {"content-disposition": disposition}
        return Response(content, media_type="application/zip", headers=headers)

    async def _write(self, work: Callable[[Connection], Any]) -> Any:
        return await asyncio.wrap_future(self._serving.writer.submit(work))

    async def _log(self, actor: str, action: str, detail: dict[str, Any]) -> None:
        await self._write(lambda connection: audit(connection, actor, action, detail))


def audit(connection: Connection, actor: str, action: str, detail: dict[str, Any]) -> None:
    connection.execute(
        insert(tables.admin_audit).values(
            at_utc=utc_now(), action=action, detail_json=to_json(detail), actor=actor
        )
    )


def zip_export(db: Place, name: str, blind: bool) -> bytes:
    """Returns the export tree of this moment as a zip file."""
    with tempfile.TemporaryDirectory() as folder:
        tree = Path(folder) / name
        export(db, tree, blind=blind)
        buffer = io.BytesIO()
        with zipfile.ZipFile(buffer, "w", zipfile.ZIP_DEFLATED) as archive:
            for path in sorted(tree.rglob("*")):
                archive.write(path, path.relative_to(tree.parent))
        return buffer.getvalue()


async def read_form(request: Request) -> Form:
    """Returns the fields of an HTML form; the first of a name counts."""
    text = (await request.body()).decode("utf-8", "replace")
    fields: Form = {}
    for name, value in parse_qsl(text, keep_blank_values=True, max_num_fields=50):
        fields.setdefault(name, value)
    return fields


def cookie_of(request: Request) -> str:
    cookie = SimpleCookie(request.headers.get("cookie", ""))
    return cookie[COOKIE].value if COOKIE in cookie else ""
