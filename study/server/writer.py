# SPDX-License-Identifier: MIT
"""The one thread that writes: many requests share a commit, and none can stop the thread."""

from __future__ import annotations

import logging
import queue
import sqlite3
import threading
from collections.abc import Callable
from concurrent.futures import Future
from dataclasses import dataclass
from typing import Any

from sqlalchemy import Connection
from sqlalchemy.exc import DBAPIError

from verisim.study.server.api_error import ApiError
from verisim.study.server.database import Place, checkpoint, writing_engine
from verisim.study.server.postgres import DISK_FULL, sql_state

log = logging.getLogger("verisim.study.writer")

MAX_BATCH = 64  # requests per commit; more would only lengthen the wait of the first
MAX_WAITING = 2000  # requests in the queue; beyond that the server says busy

Work = Callable[[Connection], Any]


@dataclass(frozen=True)
class Item:
    work: Work
    future: Future[Any]


class Writer:
    """Runs pieces of work on the database, one after another, and answers after the commit."""

    def __init__(self, db: Place) -> None:
        self._db = db
        self._queue: queue.Queue[Item | None] = queue.Queue(MAX_WAITING)
        self._lock = threading.Lock()
        self._closed = False
        self._thread = self._start()

    def submit(self, work: Work) -> Future[Any]:
        """Queues work; the future holds its result once it is on the disk, or why it is not.

        Raises ApiError 503 where the queue is full or the writer has been closed.
        """
        future: Future[Any] = Future()
        with self._lock:
            if self._closed:
                raise busy("the server is stopping")
            if not self._thread.is_alive():  # cannot happen by an exception; keep serving anyway
                log.error("the writer thread had ended; it was started again")
                self._thread = self._start()
            try:
                self._queue.put_nowait(Item(work, future))
            except queue.Full as error:
                raise busy("too many requests are waiting") from error
        return future

    def close(self) -> None:
        """Finishes what is queued, then folds the write-ahead log into the file."""
        with self._lock:
            if self._closed:
                return
            self._closed = True
        self._queue.put(None)
        self._thread.join()
        try:
            checkpoint(self._db)
        except sqlite3.Error as error:  # the log stays beside the file; nothing is lost
            log.warning("the write-ahead log could not be folded in: %s", error)

    def _start(self) -> threading.Thread:
        thread = threading.Thread(target=self._run, name="study-writer", daemon=True)
        thread.start()
        return thread

    def _run(self) -> None:
        engine = writing_engine(self._db)
        connection: Connection | None = None
        stopping = False
        while not stopping:
            batch, stopping = self._next_batch()
            try:
                connection = connection or engine.connect()
                run_batch(connection, batch)
            except Exception as error:
                # Disk full, disk fault, lost connection: nothing of this batch is stored.
                log.error("a commit failed, its %d requests are refused: %s", len(batch), error)
                settle_all(batch, storage_error(error))
                if connection is not None:
                    discard(connection)
                    connection = None
        if connection is not None:
            discard(connection)
        engine.dispose()

    def _next_batch(self) -> tuple[list[Item], bool]:
        """Waits for one request, then takes along what else is there."""
        batch: list[Item] = []
        item = self._queue.get()
        while item is not None:
            if item.future.set_running_or_notify_cancel():  # not given up by its request
                batch.append(item)
            if len(batch) >= MAX_BATCH:
                return batch, False
            try:
                item = self._queue.get_nowait()
            except queue.Empty:
                return batch, False
        return batch, True


def run_batch(connection: Connection, batch: list[Item]) -> None:
    """Runs each item in a savepoint of one transaction and answers all after the commit.

    An item that raises is rolled back alone. Raises if the transaction itself fails.
    """
    if not batch:
        return
    outcomes: list[tuple[Item, Any, Exception | None]] = []
    with connection.begin():
        for item in batch:
            savepoint = connection.begin_nested()
            try:
                result = item.work(connection)
                savepoint.commit()
                outcomes.append((item, result, None))
            except Exception as error:
                if is_storage_fault(error):
                    raise
                savepoint.rollback()
                outcomes.append((item, None, error))
    for item, result, fault in outcomes:
        if fault is not None:
            item.future.set_exception(fault)
        else:
            item.future.set_result(result)


def settle_all(batch: list[Item], error: Exception) -> None:
    for item in batch:
        if not item.future.done():
            item.future.set_exception(error)


def discard(connection: Connection) -> None:
    """Closes a connection whose state is unknown."""
    try:
        connection.invalidate()
        connection.close()
    except Exception as error:
        log.warning("a connection could not be closed: %s", error)


def is_storage_fault(error: Exception) -> bool:
    """True where the disk, not the request, is the cause: the whole transaction is void."""
    if not isinstance(error, DBAPIError):
        return False
    # On PostgreSQL: class 53 is lack of disk or memory, 57 and 08 a server that goes away, 55 a
    # lock that was not granted in time.
    if error.connection_invalidated or sql_state(error)[:2] in ("53", "55", "57", "58", "08"):
        return True
    return primary_code(error) in (
        sqlite3.SQLITE_FULL,
        sqlite3.SQLITE_IOERR,
        sqlite3.SQLITE_NOMEM,
        sqlite3.SQLITE_CORRUPT,
        sqlite3.SQLITE_READONLY,
        sqlite3.SQLITE_CANTOPEN,
    )


def primary_code(error: DBAPIError) -> int:
    # The low byte of SQLite's extended code is the family of the fault.
    return int(getattr(error.orig, "sqlite_errorcode", 0)) & 0xFF


def storage_error(error: Exception) -> ApiError:
    """What the page is told: 507 where the disk refused, 503 otherwise; both mean: retry."""
    if isinstance(error, DBAPIError) and (
        primary_code(error) in (sqlite3.SQLITE_FULL, sqlite3.SQLITE_IOERR)
        or sql_state(error) == DISK_FULL
    ):
        return ApiError(
            507,
            "storage_full",
            "the answer could not be written: the server's disk is full or refuses writes",
            "free some space on the server; the page tries again by itself",
        )
    return busy("the answer could not be stored just now")


def busy(message: str) -> ApiError:
    return ApiError(503, "busy", message, "try again in a moment")
