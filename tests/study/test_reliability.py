# SPDX-License-Identifier: MIT
"""No acknowledged answer is lost: kills under load, repeats, a full disk, a second server."""

from __future__ import annotations

import contextlib
import socket
import sqlite3
import subprocess
import threading
import time
from collections.abc import Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from pathlib import Path

import httpx
import pytest
from study_tools import Person, Server, error_code, new_id, trial_body

KILLS = 3
LOAD_THREADS = 6


def check_integrity(db: Path) -> None:
    with sqlite3.connect(db) as connection:
        assert connection.execute("PRAGMA integrity_check").fetchall() == [("ok",)]
        assert connection.execute("PRAGMA foreign_key_check").fetchall() == []


class Load:
    """Participants who answer as fast as they can and remember what was acknowledged."""

    def __init__(self, server: Server) -> None:
        self._server = server
        self.acknowledged: list[str] = []  # submission_id; list.append is atomic
        self.stop = threading.Event()
        self._threads = [threading.Thread(target=self._run) for _ in range(LOAD_THREADS)]
        for thread in self._threads:
            thread.start()

    def _run(self) -> None:
        while not self.stop.is_set():
            try:
                person = Person.ready(self._server)
                while not self.stop.is_set() and (trial := person.next()["trial"]) is not None:
                    body = trial_body(trial["trial_id"])
                    if person.post("trials", **body).status_code == 201:
                        self.acknowledged.append(body["submission_id"])
            except (httpx.TransportError, AssertionError):
                return  # the server is gone

    def join(self) -> None:
        self.stop.set()
        for thread in self._threads:
            thread.join()


def test_no_acknowledged_answer_is_lost_when_the_server_is_killed(
    study_path: Path, set_dir: Path, tmp_path: Path
) -> None:
    db = tmp_path / "study.db"
    acknowledged: set[str] = set()
    server = Server(study_path, set_dir, db)
    for i in range(KILLS):
        if i:
            server.start()
        load = Load(server)
        goal = len(acknowledged) + 20 + 7 * i  # kill at different moments
        deadline = time.monotonic() + 20
        while len(acknowledged | set(load.acknowledged)) < goal and time.monotonic() < deadline:
            time.sleep(0.01)
        server.kill()
        load.join()
        acknowledged.update(load.acknowledged)
        assert len(acknowledged) >= goal
        check_integrity(db)
    stored = {row[0] for row in server.query("SELECT submission_id FROM submission")}
    answers = dict(
        server.query(
            "SELECT s.submission_id, count(r.response_id) FROM submission s "
            "JOIN presentation p ON p.presentation_id = json_extract(s.body, "
            "'$.presentation.presentation_id') JOIN response r USING (presentation_id) "
            "WHERE s.kind = 'trials' GROUP BY s.submission_id"
        )
    )
    server.__exit__(None, None, None)
    assert acknowledged - stored == set()
    assert {answers.get(submission) for submission in acknowledged} == {3}


def test_twenty_identical_posts_at_once_store_one_row(server: Server) -> None:
    person = Person.ready(server)
    trial_id = person.trial()["trial_id"]
    body = trial_body(trial_id)

    def send(_number: int) -> int:
        with server.client(person.token) as client:
            return client.post("/api/trials", json=body).status_code

    with ThreadPoolExecutor(20) as pool:
        codes = sorted(pool.map(send, range(20)))
    assert codes == [200] * 19 + [201]
    assert server.query("SELECT count(*) FROM response WHERE trial_id = ?", trial_id) == [(3,)]
    assert server.query("SELECT count(*) FROM presentation WHERE trial_id = ?", trial_id) == [(1,)]


def test_a_second_answer_to_a_trial_is_logged_and_the_first_stands(server: Server) -> None:
    person = Person.ready(server)
    trial_id = person.trial()["trial_id"]
    first, second = trial_body(trial_id), trial_body(trial_id)
    second["responses"][0]["value"] = 7
    assert person.post("trials", **first).status_code == 201
    for _ in range(2):
        reply = person.post("trials", **second)
        assert (reply.status_code, error_code(reply)) == (409, "already_answered")
    rows = server.query(
        "SELECT value FROM response JOIN question USING (question_id) "
        "WHERE trial_id = ? AND key = 'realism'",
        trial_id,
    )
    assert rows == [(4.0,)]
    logged = "SELECT outcome FROM submission WHERE submission_id = ?"
    assert server.query(logged, second["submission_id"]) == [("already_answered",)]


def test_a_submission_id_cannot_carry_two_bodies(server: Server) -> None:
    person = Person.ready(server)
    body = trial_body(person.trial()["trial_id"])
    assert person.post("trials", **body).status_code == 201
    changed = {**body, "responses": []}
    assert error_code(person.post("trials", **changed)) == "submission_id_reused"
    other = Person.ready(server)
    assert error_code(other.post("trials", **body)) == "submission_id_taken"


def test_answers_are_final_in_the_database_itself(server: Server) -> None:
    Person.ready(server).answer_next()
    for sql in (
        "UPDATE response SET value = 7",
        "DELETE FROM response",
        "UPDATE submission SET body = '{}'",
        "UPDATE submission SET body = '', outcome = 'already_answered'",  # emptied alone it may be
        "DELETE FROM submission",
    ):
        with pytest.raises(sqlite3.IntegrityError, match=r"never changed|only with"):
            server.query(sql)


def test_ctrl_c_ends_cleanly_and_folds_the_log_in(
    study_path: Path, set_dir: Path, tmp_path: Path
) -> None:
    with Server(study_path, set_dir, tmp_path / "study.db") as server:
        Person.ready(server).answer_next()
        assert server.interrupt() == 0
        assert "Traceback" not in server.read_errors()
    assert not (tmp_path / "study.db-wal").exists()
    check_integrity(tmp_path / "study.db")


def test_a_second_server_on_the_same_database_is_refused(server: Server) -> None:
    with Server(server.study, server.set_dir, server.db) as second:
        assert second.wait() == 1
        errors = second.read_errors()
    assert f"in use by another server (process {server.process.pid})" in errors
    assert "hint:" in errors and "Traceback" not in errors


def test_a_port_in_use_is_named(study_path: Path, set_dir: Path, tmp_path: Path) -> None:
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        port = taken.getsockname()[1]
        with Server(study_path, set_dir, tmp_path / "study.db", port=port) as server:
            assert server.wait() == 1
            errors = server.read_errors()
    assert f"127.0.0.1:{port}: the port is in use" in errors and "hint:" in errors


def test_the_log_of_requests_holds_no_address(
    study_path: Path, set_dir: Path, tmp_path: Path
) -> None:
    with Server(study_path, set_dir, tmp_path / "study.db") as server:
        Person.ready(server)
        server.interrupt()
        log = server.read_errors()
    assert "POST /api/sessions 201" in log
    assert "127.0.0.1" not in log


@pytest.fixture
def small_disk(tmp_path: Path) -> Iterator[Path]:
    """A file system of 1.5 MB; where mounting is not allowed, the test cannot run."""
    disk = tmp_path / "disk"
    disk.mkdir()
    mount = ["mount", "-t", "tmpfs", "-o", "size=1536k", "tmpfs", str(disk)]
    if subprocess.run(mount, capture_output=True, check=False).returncode != 0:
        pytest.skip("mounting a tmpfs is not permitted here; the file size limit test still runs")
    yield disk
    subprocess.run(["umount", "-l", str(disk)], check=True)


def fill(ballast: Path) -> None:
    """Writes to a file until no block is left."""
    with ballast.open("wb", buffering=0) as file, contextlib.suppress(OSError):
        while file.write(b"\0" * 4096) == 4096:
            pass


def test_a_full_disk_refuses_with_507_and_recovers(
    study_path: Path, set_dir: Path, small_disk: Path
) -> None:
    ballast = small_disk / "ballast"
    with Server(study_path, set_dir, small_disk / "study.db") as server:
        person = Person.ready(server)
        assert person.answer_next().status_code == 201
        fill(ballast)  # somebody else fills the disk
        trial_id = person.trial()["trial_id"]
        body = trial_body(trial_id)
        codes = set()
        for _ in range(3):
            reply = person.post("trials", **body)
            codes.add((reply.status_code, error_code(reply)))
        assert codes == {(507, "storage_full")}
        assert person.client.get("/readyz").status_code == 507
        assert person.trial()["trial_id"] == trial_id  # reading goes on
        ballast.unlink()
        assert person.post("trials", **body).status_code == 201
        assert person.client.get("/readyz").status_code == 200
        assert server.query("SELECT count(*) FROM response") == [(6,)]
        check_integrity(server.db)


def test_a_write_refused_by_the_system_gives_507_and_recovers(
    study_path: Path, set_dir: Path, tmp_path: Path
) -> None:
    # The kernel refuses to let any file of the server grow: a real failed write, no rights needed.
    with Server(study_path, set_dir, tmp_path / "study.db") as server:
        person = Person.ready(server)
        body = trial_body(person.trial()["trial_id"])
        pid = str(server.process.pid)
        subprocess.run(["prlimit", "--pid", pid, "--fsize=4096:"], check=True)
        reply = person.post("trials", **body)
        assert (reply.status_code, error_code(reply)) == (507, "storage_full")
        subprocess.run(["prlimit", "--pid", pid, "--fsize=unlimited:"], check=True)
        assert person.post("trials", **body).status_code == 201
        check_integrity(server.db)


def test_a_restarted_server_goes_on_where_everybody_was(
    study_path: Path, set_dir: Path, tmp_path: Path
) -> None:
    with Server(study_path, set_dir, tmp_path / "study.db") as server:
        person = Person.ready(server)
        person.answer_next()
        expected = person.trial()
        body = trial_body(expected["trial_id"])
        server.kill()  # while the clip plays
        server.start()
        again = Person(server, person.token, "", "", server.client(person.token))
        assert again.trial() == expected
        assert again.post("trials", **body).status_code == 201
        assert again.post("trials", **body).status_code == 200
        assert again.next()["progress"]["done"] == 2


def test_a_stuck_database_is_answered_with_503_in_time(
    study_path: Path, set_dir: Path, tmp_path: Path
) -> None:
    with Server(study_path, set_dir, tmp_path / "study.db") as server:
        person = Person.ready(server)
        blocker = sqlite3.connect(server.db, isolation_level=None)
        blocker.execute("BEGIN IMMEDIATE")
        try:
            began = time.monotonic()
            assert person.client.get("/readyz").status_code == 503
            assert time.monotonic() - began < 8  # readiness gives up after 2 s
        finally:
            blocker.execute("ROLLBACK")
            blocker.close()
        assert person.post("instructions", submission_id=new_id()).status_code == 409
        assert person.answer_next().status_code == 201


def test_the_writer_survives_work_that_raises(tmp_path: Path) -> None:
    from verisim.study.server.database import prepare_database
    from verisim.study.server.writer import Writer

    db = tmp_path / "study.db"
    prepare_database(db)
    writer = Writer(db)

    def fail(_connection: object) -> None:
        raise OverflowError("Python int too large to convert to SQLite INTEGER")

    futures = [writer.submit(fail), writer.submit(lambda _connection: 42), writer.submit(fail)]
    with pytest.raises(OverflowError):
        futures[0].result(5)
    assert futures[1].result(5) == 42
    writer.close()


def test_an_item_that_fails_takes_no_other_with_it(tmp_path: Path) -> None:
    from sqlalchemy import Connection, insert

    from verisim.study.server import tables
    from verisim.study.server.database import prepare_database, writing_engine
    from verisim.study.server.writer import Item, run_batch

    db = tmp_path / "study.db"
    prepare_database(db)

    def beat(number: int, fail: bool) -> Item:
        def work(connection: Connection) -> int:
            connection.execute(insert(tables.heartbeat).values(heartbeat_id=number, at_utc="now"))
            if fail:
                raise ValueError(number)
            return number

        return Item(work, Future())

    items = [beat(1, False), beat(2, True), beat(3, False), beat(1, False)]
    with writing_engine(db).connect() as writing:
        run_batch(writing, items)
    assert [item.future.exception() is None for item in items] == [True, False, True, False]
    with sqlite3.connect(db) as connection:
        rows = connection.execute("SELECT heartbeat_id FROM heartbeat ORDER BY 1").fetchall()
    assert rows == [(1,), (3,)]
