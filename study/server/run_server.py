# SPDX-License-Identifier: MIT
"""Runs the server for one study: lock, database, socket, and an end that leaves nothing behind."""

from __future__ import annotations

import errno
import socket
import threading
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path

import uvicorn
from starlette.types import ASGIApp

from verisim.study.problems import refuse
from verisim.study.server.app import Serving, create_app
from verisim.study.server.database import Place, lock_of, reading_engine
from verisim.study.server.open_study import open_study
from verisim.study.server.study_file import SOURCES
from verisim.study.server.writer import Writer

GRACE_S = 5  # for requests in progress when the server is asked to stop

OnReady = Callable[[str], None]


class StudyServer(uvicorn.Server):
    """Tells its address once it answers."""

    def __init__(self, config: uvicorn.Config, address: str, on_ready: OnReady) -> None:
        super().__init__(config)
        self.address = address
        self._on_ready = on_ready

    async def startup(self, sockets: list[socket.socket] | None = None) -> None:
        await super().startup(sockets)
        self._on_ready(self.address)


@dataclass(frozen=True)
class ServeOptions:
    """How a study is served."""

    host: str = "127.0.0.1"
    port: int = 8000  # 0: any free one
    source_default: str = "link"
    simulate_key: str | None = None
    mode: str = "open"  # open | pilot | live
    kiosk: bool = False
    admin_port: int | None = None  # None: no administration page; 0: any free port


def serve(
    study: Path,
    set_dir: Path,
    db: Place,
    host: str = "127.0.0.1",
    port: int = 8000,
    *,
    source_default: str = "link",
    simulate_key: str | None = None,
    mode: str = "open",
    kiosk: bool = False,
    admin_port: int | None = None,
    on_ready: OnReady = lambda _address: None,
    on_admin: OnReady = lambda _address: None,
) -> None:
    """Serves a study until Ctrl-C or SIGTERM; then finishes requests and folds the log in.

    port 0 takes a free one. on_ready is called with the address as soon as the server answers,
    on_admin before it with that of the administration page, if there is one. Raises StudyError for
    wrong files, a port in use, a database that another server uses, and a live study that is not
    as it was frozen.
    """
    options = ServeOptions(host, port, source_default, simulate_key, mode, kiosk, admin_port)
    with (
        _prepared(study, set_dir, db, options, on_ready, on_admin) as (server, listener),
        suppress(KeyboardInterrupt),
    ):  # Ctrl-C is the way to stop; all is written by now
        server.run(sockets=[listener])


@contextmanager
def serving_in_background(
    study: Path, set_dir: Path, db: Place, port: int, *, simulate_key: str
) -> Iterator[str]:
    """Runs the same server in a thread of this process; yields its address."""
    ready = threading.Event()
    options = ServeOptions(port=port, simulate_key=simulate_key)
    with _prepared(study, set_dir, db, options, lambda _address: ready.set()) as (
        server,
        listener,
    ):
        thread = threading.Thread(target=server.run, args=([listener],), name="study-server")
        thread.start()
        try:
            while not ready.wait(0.05):
                if not thread.is_alive():
                    raise refuse(db, "the study server did not start", "see the messages above")
            yield server.address
        finally:
            server.should_exit = True
            thread.join()


@contextmanager
def _prepared(
    study: Path,
    set_dir: Path,
    db: Place,
    options: ServeOptions,
    on_ready: OnReady,
    on_admin: OnReady = lambda _address: None,
) -> Iterator[tuple[StudyServer, socket.socket]]:
    """Takes lock, database and ports, in this order, and gives them back."""
    if options.source_default not in SOURCES or options.source_default == "simulated":
        allowed = ", ".join(source for source in SOURCES if source != "simulated")
        raise refuse(
            "source", f"{options.source_default!r} is not allowed", f"give one of {allowed}"
        )
    if isinstance(db, Path):
        db.parent.mkdir(parents=True, exist_ok=True)
    with lock_of(db):
        opened = open_study(study, set_dir, db, options.mode)
        with _bound(options.host, options.port) as listener, ExitStack() as stack:
            serving = Serving(
                opened,
                Writer(db),
                reading_engine(db),
                db,
                options.source_default,
                options.simulate_key,
                options.mode,
                options.kiosk,
            )
            stack.callback(serving.reader.dispose)
            stack.callback(serving.writer.close)
            if options.admin_port is not None:
                on_admin(stack.enter_context(_administered(serving, options.admin_port)))
            shown = f"[{options.host}]" if ":" in options.host else options.host
            address = f"http://{shown}:{listener.getsockname()[1]}"
            yield StudyServer(_config(create_app(serving)), address, on_ready), listener


def _config(app: ASGIApp) -> uvicorn.Config:
    return uvicorn.Config(
        app,
        access_log=False,  # uvicorn's own would print addresses; Guard logs without
        log_level="warning",
        server_header=False,
        timeout_graceful_shutdown=GRACE_S,
        ws="none",
    )


@contextmanager
def _administered(serving: Serving, port: int) -> Iterator[str]:
    """Runs the administration page on the loopback address alone; yields where it is."""
    from verisim.study.server.admin.app import create_admin_app
    from verisim.study.server.admin.login import has_accounts

    with serving.reader.begin() as connection:
        if not has_accounts(connection):
            hint = "make one: `verisim study admin-password NAME --db FILE`"
            raise refuse("admin", "there is no account to log in with", hint)
    with _bound("127.0.0.1", port) as listener:
        number = listener.getsockname()[1]
        hosts = tuple(f"{name}:{number}" for name in ("127.0.0.1", "localhost"))
        server = uvicorn.Server(_config(create_admin_app(serving, hosts)))
        thread = threading.Thread(target=server.run, args=([listener],), name="study-admin")
        thread.start()
        try:
            yield f"http://127.0.0.1:{number}"
        finally:
            server.should_exit = True
            thread.join()


@contextmanager
def _bound(host: str, port: int) -> Iterator[socket.socket]:
    """Yields a socket that holds the port, so that a port in use is found before anything runs."""
    where = f"{host}:{port}"
    try:
        info = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM)[0]
        # Without the protocol asyncio would not switch Nagle's delay off: 40 ms per answer.
        listener = socket.socket(*info[:3])
    except (OSError, OverflowError) as error:
        raise refuse(where, f"not an address to listen on: {error}", "try 127.0.0.1") from error
    with listener:
        listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            listener.bind(info[4])
            listener.listen(512)
        except OSError as error:
            if error.errno == errno.EADDRINUSE:
                hint = "stop the program that uses it, or give another --port (0: any free one)"
                raise refuse(where, "the port is in use", hint) from error
            raise refuse(where, f"cannot listen: {error.strerror}", "give another port") from error
        yield listener
