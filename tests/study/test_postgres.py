# SPDX-License-Identifier: MIT
"""The same study on PostgreSQL: the same tables and answers, and several server processes."""

from __future__ import annotations

import csv
import threading
from collections import Counter
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import psycopg
import pytest
from alembic.autogenerate import compare_metadata
from alembic.migration import MigrationContext
from postgres_tools import create_database, running_postgres
from study_tools import FULL, Person, Server, new_id, trial_body, write_study

from verisim.study.export import export
from verisim.study.problems import StudyError
from verisim.study.server import simulate
from verisim.study.server.database import prepare_database, read_place, reading_engine
from verisim.study.server.erasure import erase_participant
from verisim.study.server.tables import metadata


@pytest.fixture(scope="module")
def cluster() -> Iterator[str]:
    with running_postgres() as folder:
        yield folder


def rows(url: str, sql: str) -> list[tuple[object, ...]]:
    with psycopg.connect(url) as connection:
        return connection.execute(sql.encode()).fetchall()


def test_the_migrations_give_the_tables_of_the_code(cluster: str) -> None:
    place = read_place(create_database(cluster, "tables"))
    prepare_database(place)
    prepare_database(place)
    with reading_engine(place).connect() as connection:
        assert compare_metadata(MigrationContext.configure(connection), metadata) == []


def test_a_whole_study_runs_exports_and_is_erased(
    cluster: str, set_dir: Path, tmp_path: Path
) -> None:
    url = create_database(cluster, "whole")
    study = write_study(tmp_path, FULL)
    simulate(study, set_dir, read_place(url), 4, 1)
    simulate(study, set_dir, tmp_path / "lite.db", 4, 1)
    export(read_place(url), tmp_path / "pg")
    export(tmp_path / "lite.db", tmp_path / "lite")

    def answers(tree: str) -> Counter[tuple[str, ...]]:
        path = tmp_path / tree / "data" / "study-mini_table-ratings_data.csv"
        with path.open(newline="") as file:
            columns = (
                "trial_index",
                "stimulus",
                "question",
                "item",
                "value",
                "value_text",
                "rt_ms",
            )
            return Counter(tuple(row[c] for c in columns) for row in csv.DictReader(file))

    assert answers("pg") == answers("lite") and answers("pg").total() > 100
    code = rows(url, "SELECT completion_code FROM participant LIMIT 1")[0][0]
    assert erase_participant(read_place(url), str(code), "asked for") > 20
    assert rows(url, "SELECT count(*) FROM participant") == [(3,)]
    with pytest.raises(psycopg.errors.RaiseException, match="never changed"):
        rows(url, "UPDATE response SET value = 1")


def test_several_servers_share_a_study_and_lose_nothing(
    cluster: str, set_dir: Path, study_path: Path
) -> None:
    url = create_database(cluster, "several")
    with (
        Server(study_path, set_dir, url) as first,
        Server(study_path, set_dir, url) as second,
        Server(study_path, set_dir, url) as third,
    ):
        servers = (first, second, third)
        acknowledged: list[str] = []
        lock = threading.Lock()

        def take_part(i: int) -> None:
            person = Person.ready(servers[i % 3])
            for n in range(5):
                other = servers[(i + n) % 3]  # a balancer may send each request elsewhere
                with other.client(person.token) as client:
                    trial_id = client.get("/api/next").json()["trial"]["trial_id"]
                    body = trial_body(trial_id)
                    assert client.post("/api/trials", json=body).status_code == 201
                with lock:
                    acknowledged.append(body["submission_id"])

        with ThreadPoolExecutor(12) as pool:
            list(pool.map(take_part, range(12)))
        stored = {row[0] for row in rows(url, "SELECT submission_id FROM submission")}
        assert len(acknowledged) == 60 and set(acknowledged) <= stored
        lists = rows(url, "SELECT list_no FROM assignment")
        assert sorted(lists) == [(i,) for i in range(12)]  # each list once

        person = Person.ready(first)
        body = trial_body(person.trial()["trial_id"])

        def send(i: int) -> int:
            with servers[i % 3].client(person.token) as client:
                return client.post("/api/trials", json=body).status_code

        with ThreadPoolExecutor(20) as pool:
            codes = Counter(pool.map(send, range(20)))
        assert codes == {201: 1, 200: 19}


def test_a_killed_server_loses_no_acknowledged_answer(
    cluster: str, set_dir: Path, study_path: Path
) -> None:
    url = create_database(cluster, "killed")
    acknowledged = []
    with Server(study_path, set_dir, url) as server:
        person = Person.ready(server)
        for _ in range(3):
            body = trial_body(person.trial()["trial_id"], submission_id=new_id())
            assert person.post("trials", **body).status_code == 201
            acknowledged.append(body["submission_id"])
        server.kill()
        server.start()
        with server.client(person.token) as client:
            assert client.get("/api/next").json()["progress"]["done"] == 3
    stored = {row[0] for row in rows(url, "SELECT submission_id FROM submission")}
    assert set(acknowledged) <= stored


def test_an_address_that_leads_nowhere_is_refused_plainly() -> None:
    with pytest.raises(StudyError, match="is no PostgreSQL database"):
        read_place("mysql://host/name")
    with pytest.raises(StudyError, match="cannot be reached"):
        prepare_database(read_place("postgresql://nobody:geheim@127.0.0.1:1/none"))
    try:
        prepare_database(read_place("postgresql://nobody:geheim@127.0.0.1:1/none"))
    except StudyError as error:
        assert "geheim" not in str(error)
