# SPDX-License-Identifier: MIT
"""The HTTP interface: each route names its body and the work that the writer does with it."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager
from dataclasses import dataclass
from functools import partial
from typing import Any

from fastapi import FastAPI, Request
from fastapi.responses import HTMLResponse, JSONResponse, Response
from sqlalchemy import Connection, Engine
from starlette.exceptions import HTTPException
from starlette.types import ASGIApp

from verisim.study.server import answers, bodies, steps, tables
from verisim.study.server.api_error import ApiError
from verisim.study.server.database import Place, checkpoint, insert_for, utc_now
from verisim.study.server.describe_study import describe_study
from verisim.study.server.enrolment import choose_source, enrol, hash_token
from verisim.study.server.guard import Guard
from verisim.study.server.open_study import OpenStudy
from verisim.study.server.pages import add_pages
from verisim.study.server.position import next_step
from verisim.study.server.reply import Reply
from verisim.study.server.submissions import Caller, Post, find_caller
from verisim.study.server.withdrawal import withdraw, withdraw_by_link
from verisim.study.server.writer import Work, Writer

READY_S = 2.0
MAX_TOKEN_CHARS = 100
NO_SUCH_PAGE = (
    '<!doctype html><html lang="en"><meta charset="utf-8"><title>No such page</title>'
    "<h1>There is no such page</h1><p>Please open the link that you were given.</p></html>"
)
# What the writer does with a participant's body: (connection, study, caller, post, body) → reply.
Store = Callable[[Connection, OpenStudy, Caller, Post, Any], Reply]
POSTS: dict[str, tuple[type[bodies.Body], Store]] = {
    "consent": (bodies.ConsentBody, steps.store_consent),
    "screen": (bodies.ScreenBody, steps.store_screen),
    "instructions": (bodies.InstructionsBody, steps.store_instructions),
    "trials": (bodies.TrialBody, answers.store_trial),
    "presentations": (bodies.PresentationBody, answers.store_presentation),
    "events": (bodies.EventsBody, answers.store_events),
    "end_questions": (bodies.EndBody, steps.store_end),
    "stop": (bodies.StopBody, steps.store_stop),
}


@dataclass(frozen=True)
class Serving:
    """What the routes work with."""

    opened: OpenStudy
    writer: Writer
    reader: Engine
    db: Place
    source_default: str
    simulate_key: str | None
    mode: str = "open"  # open | pilot | live
    kiosk: bool = False


def create_app(serving: Serving) -> ASGIApp:
    """Returns the application. It owns writer and reader and closes them at its end."""

    @asynccontextmanager
    async def lifespan(_app: FastAPI) -> AsyncIterator[None]:
        yield
        await asyncio.to_thread(serving.writer.close)
        serving.reader.dispose()

    app = FastAPI(lifespan=lifespan, docs_url=None, redoc_url=None, openapi_url=None)
    add_error_forms(app)
    add_health(app, serving)
    add_api(app, serving)
    clips = serving.opened.stimulus_set
    add_pages(app, {stimulus.sha256: clips.clip_path(stimulus) for stimulus in clips.stimuli})
    return Guard(app)


def add_error_forms(app: FastAPI) -> None:
    """Every error leaves in one form."""

    @app.exception_handler(ApiError)
    async def api_error(_request: Request, error: Exception) -> JSONResponse:
        assert isinstance(error, ApiError)
        headers = {"retry-after": "1"} if error.status in (429, 503, 507) else None
        return JSONResponse(error.body(), error.status, headers)

    @app.exception_handler(HTTPException)
    async def http_error(request: Request, error: Exception) -> Response:
        assert isinstance(error, HTTPException)
        if error.status_code == 404 and "text/html" in request.headers.get("accept", ""):
            return HTMLResponse(NO_SUCH_PAGE, 404)  # somebody who mistyped the address
        named = ApiError(error.status_code, "not_found", str(error.detail), "see the HTTP contract")
        return JSONResponse(named.body(), error.status_code)

    @app.exception_handler(Exception)
    async def unexpected(_request: Request, _error: Exception) -> JSONResponse:
        hidden = ApiError(500, "internal", "the server made a mistake", "tell the person in charge")
        return JSONResponse(hidden.body(), 500)


def add_health(app: FastAPI, serving: Serving) -> None:
    @app.get("/healthz")
    async def healthz() -> dict[str, str]:
        return {"status": "alive"}

    @app.get("/readyz")
    async def readyz() -> dict[str, str]:
        def beat(connection: Connection) -> None:
            row = {"heartbeat_id": 1, "at_utc": utc_now()}
            upsert = insert_for(connection, tables.heartbeat).values(row)
            connection.execute(
                upsert.on_conflict_do_update(index_elements=["heartbeat_id"], set_=row)
            )

        try:
            await asyncio.wait_for(committed(serving.writer, beat), READY_S)
        except TimeoutError as error:
            raise ApiError(503, "busy", "the database takes no writes just now") from error
        return {"status": "ready"}


def add_api(app: FastAPI, serving: Serving) -> None:
    @app.get("/api/study")
    def study(lang: str = "") -> dict[str, Any]:
        with serving.reader.begin() as connection:
            return describe_study(
                connection,
                serving.opened,
                lang,
                mode=serving.mode,
                kiosk=serving.kiosk,
                is_simulating=serving.simulate_key is not None,
            )

    @app.get("/api/next")
    def step(request: Request) -> dict[str, Any]:
        token = read_token(request)
        with serving.reader.begin() as connection:
            return next_step(connection, serving.opened, find_caller(connection, token))

    @app.post("/api/sessions")
    async def sessions(request: Request) -> JSONResponse:
        body = bodies.parse_body(bodies.SessionBody, await request.body())
        source = choose_source(body, serving.source_default, serving.simulate_key, serving.mode)
        work = partial(enrol, opened=serving.opened, body=body, source=source)
        return respond(await committed(serving.writer, work))

    @app.post("/api/withdraw")
    async def withdraw_by_token(request: Request) -> JSONResponse:
        token = read_token(request)
        bodies.parse_body(bodies.WithdrawBody, await request.body())
        return await erased(lambda connection: withdraw(connection, find_caller(connection, token)))

    @app.post("/api/withdraw_by_link")
    async def withdraw_by_secret(request: Request) -> JSONResponse:
        body = bodies.parse_body(bodies.WithdrawByLinkBody, await request.body())
        return await erased(lambda connection: withdraw_by_link(connection, body.withdrawal))

    async def erased(work: Work) -> JSONResponse:
        reply = await committed(serving.writer, work)
        # What was deleted would otherwise stay readable in the write-ahead log.
        await asyncio.to_thread(checkpoint, serving.db)
        return respond(reply)

    def add_post(kind: str, model: type[bodies.Body], store: Store) -> None:
        @app.post(f"/api/{kind}", name=kind)
        async def post(request: Request) -> JSONResponse:
            token = read_token(request)
            raw = await request.body()
            body = bodies.parse_body(model, raw)
            posted = Post(body.submission_id, kind, raw)

            def work(connection: Connection) -> Reply:
                caller = find_caller(connection, token)
                return store(connection, serving.opened, caller, posted, body)

            return respond(await committed(serving.writer, work))

    for kind, (model, store) in POSTS.items():
        add_post(kind, model, store)


async def committed(writer: Writer, work: Work) -> Any:
    """Waits until the work is on the disk and returns its result."""
    return await asyncio.wrap_future(writer.submit(work))


def respond(reply: Reply) -> JSONResponse:
    return JSONResponse(reply.body, reply.status)


def read_token(request: Request) -> str:
    """Returns the hash of the bearer token. Raises ApiError 401 where there is none."""
    scheme, _, token = request.headers.get("authorization", "").partition(" ")
    if scheme.lower() != "bearer" or not token or len(token) > MAX_TOKEN_CHARS:
        raise ApiError(401, "no_token", "no token was sent", "open a session: POST /api/sessions")
    return hash_token(token)
