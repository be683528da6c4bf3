# SPDX-License-Identifier: MIT
"""Runs the server for one study: lock, database, socket, and an end that leaves nothing behind."""

from __future__ import annotations

import errno
import socket
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

import uvicorn

from verisim.study.problems import refuse
from verisim.study.server.app import Serving, create_app
from verisim.study.server.database import DatabaseLock, reading_engine
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


def serve(
    study: Path,
    set_dir: Path,
    db: Path,
    host: str = "127.0.0.1",
    port: int = 8000,
    *,
    source_default: str = "link",
    simulate_key: str | None = None,
    on_ready: OnReady = lambda _address: None,
) -> None:
    """Serves a study until Ctrl-C or SIGTERM; then finishes requests and folds the log in.

    port 0 takes a free one. on_ready is called with the address as soon as the server answers.
    Raises StudyError for wrong files, a port in use and a database that another server uses.
    """
    with (
        _prepared(study, set_dir, db, host, port, source_default, simulate_key, on_ready) as (
            server,
            listener,
        ),
        suppress(KeyboardInterrupt),
    ):  # Ctrl-C is the way to stop; all is written by now
        server.run(sockets=[listener])


@contextmanager
def serving_in_background(
    study: Path, set_dir: Path, db: Path, port: int, *, simulate_key: str
) -> Iterator[str]:
    """Runs the same server in a thread of this process; yields its address."""
    ready = threading.Event()
    with _prepared(
        study, set_dir, db, "127.0.0.1", port, "link", simulate_key, lambda _address: ready.set()
    ) as (server, listener):
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
    db: Path,
    host: str,
    port: int,
    source_default: str,
    simulate_key: str | None,
    on_ready: OnReady,
) -> Iterator[tuple[StudyServer, socket.socket]]:
    """Takes lock, database and port, in this order, and gives them back."""
    if source_default not in SOURCES or source_default == "simulated":
        allowed = ", ".join(source for source in SOURCES if source != "simulated")
        raise refuse("source", f"{source_default!r} is not allowed", f"give one of {allowed}")
    db.parent.mkdir(parents=True, exist_ok=True)
    with DatabaseLock(db):
        opened = open_study(study, set_dir, db)
        with _bound(host, port) as listener:
            serving = Serving(
                opened, Writer(db), reading_engine(db), db, source_default, simulate_key
            )
            config = uvicorn.Config(
                create_app(serving),
                access_log=False,  # uvicorn's own would print addresses; Guard logs without
                log_level="warning",
                server_header=False,
                timeout_graceful_shutdown=GRACE_S,
                ws="none",
            )
            shown = f"[{host}]" if ":" in host else host
            address = f"http://{shown}:{listener.getsockname()[1]}"
            try:
                yield StudyServer(config, address, on_ready), listener
            finally:
                serving.writer.close()
                serving.reader.dispose()


@contextmanager
def _bound(host: str, port: int) -> Iterator[socket.socket]:
    """Yields a socket that holds the port, so that a port in use is found before anything runs."""
    where = f"{host}:{port}"
    try:
        info = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM)[0]
        listener = socket.socket(info[0], info[1])
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
