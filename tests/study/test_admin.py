# SPDX-License-Identifier: MIT
"""The administration page: on loopback alone, behind a login, every act checked and logged."""

from __future__ import annotations

import io
import re
import zipfile
from collections.abc import Iterator
from pathlib import Path

import httpx
import pytest
from study_tools import Person, Server, error_code, new_id, response, session_body, trial_body

from verisim.study.problems import StudyError
from verisim.study.server.admin.login import Brake, set_password
from verisim.study.server.researcher import at_work_on

PASSWORD = "correct horse battery"


@pytest.fixture(scope="module")
def admin(
    set_dir: Path, study_path: Path, tmp_path_factory: pytest.TempPathFactory
) -> Iterator[Server]:
    db = tmp_path_factory.mktemp("admin") / "study.db"
    with at_work_on(study_path, set_dir, db) as connection:
        set_password(connection, "ada", PASSWORD)
    with Server(study_path, set_dir, db, admin_port=0) as server:
        yield server


def visit(server: Server) -> httpx.Client:
    return httpx.Client(base_url=server.admin, timeout=20, trust_env=False)


def log_in(client: httpx.Client, password: str = PASSWORD) -> httpx.Response:
    return client.post("/login", data={"name": "ada", "password": password})


def csrf(client: httpx.Client) -> str:
    found = re.search(r'name="csrf" value="([^"]+)"', client.get("/").text)
    assert found is not None
    return found[1]


def test_it_listens_on_the_loopback_address_and_not_on_the_participants_port(
    admin: Server,
) -> None:
    assert admin.admin.startswith("http://127.0.0.1:") and admin.admin != admin.address
    with admin.client() as client:
        for path in ("/login", "/export", "/state", "/erase"):
            assert client.post(path).status_code in (404, 405)
    with visit(admin) as client:
        assert client.get("/", headers={"host": "evil.example"}).status_code == 421


def test_nothing_is_shown_or_done_without_a_login(admin: Server) -> None:
    with visit(admin) as client:
        page = client.get("/")
        assert "Password" in page.text and "Participants" not in page.text
        assert log_in(client, "wrong password!").status_code == 401
        for path in ("/state", "/erase", "/forget", "/export"):
            assert client.post(path, data={"state": "closed"}).status_code == 303
    assert admin.query("SELECT state FROM study") == [("open",)]


def test_the_page_needs_no_network_and_is_fenced(admin: Server) -> None:
    with visit(admin) as client:
        reply = log_in(client)
        assert reply.status_code == 303
        cookie = reply.headers["set-cookie"].lower()
        assert "httponly" in cookie and "samesite=strict" in cookie
        page = client.get("/")
        assert not re.search(r'(?:src|href)="(?:https?:)?//', page.text)
        policy = page.headers["content-security-policy"]
        assert "default-src 'none'" in policy and "form-action 'self'" in policy
        assert page.headers["cache-control"] == "no-store"


def test_the_page_renews_itself_only_where_nothing_can_be_typed(admin: Server) -> None:
    with visit(admin) as client:
        assert client.get("/still").status_code == 303  # to the login
        log_in(client)
        overview, still = client.get("/").text, client.get("/still").text
    assert 'http-equiv="refresh"' in overview and 'name="reason"' not in overview
    assert 'http-equiv="refresh"' not in still and 'action="/erase"' in still


def test_a_form_of_another_page_is_refused(admin: Server) -> None:
    with visit(admin) as client:
        log_in(client)
        for token in ("", "guess"):
            forged = client.post("/state", data={"state": "closed", "csrf": token})
            assert forged.status_code == 403
    assert admin.query("SELECT state FROM study") == [("open",)]


def test_pausing_and_closing_take_effect_and_are_logged(admin: Server) -> None:
    with visit(admin) as client:
        log_in(client)
        for state in ("paused", "closed", "open"):
            done = client.post("/state", data={"state": state, "csrf": csrf(client)})
            assert f"The study is {state} now." in done.text
            with admin.client() as people:
                reply = people.post("/api/sessions", json=session_body())
            code = 201 if state == "open" else 403
            assert reply.status_code == code
            assert state == "open" or error_code(reply) == f"study_{state}"
        assert (
            "is not allowed"
            in client.post("/state", data={"state": "burnt", "csrf": csrf(client)}).text
        )
    log = admin.query("SELECT actor, detail_json FROM admin_audit WHERE action = 'set_state'")
    assert log == [("ada", f'{{"state": "{state}"}}') for state in ("paused", "closed", "open")]


def test_progress_flags_and_comments_are_shown_safely(admin: Server) -> None:
    person = Person.ready(admin)
    body = trial_body(person.trial()["trial_id"])
    body["responses"][-1] = response("note", None, "<script>alert(1)</script>")
    body["presentation"] |= {"frames_total": 10, "frames_dropped": 4, "stall_count": 2}
    assert person.post("trials", **body).status_code == 201
    with visit(admin) as client:
        log_in(client)
        page = client.get("/").text
    assert person.participant_id in page and "1 / 8" in page
    assert "dropped frames, stalls" in page and "40.0 %" in page
    assert "<script>" not in page and "&lt;script&gt;" in page


def test_a_participant_is_erased_from_the_page_with_a_reason(admin: Server) -> None:
    person = Person.ready(admin)
    person.answer_next()
    with visit(admin) as client:
        log_in(client)
        form = {"participant": person.participant_id, "reason": "asked by mail"}
        unsure = client.post("/erase", data={**form, "csrf": csrf(client)})
        assert "Nothing was deleted" in unsure.text
        done = client.post("/erase", data={**form, "sure": "1", "csrf": csrf(client)})
        assert "Deleted, 4 answers with it." in done.text
        again = client.post("/erase", data={**form, "sure": "1", "csrf": csrf(client)})
        assert "Nobody has this code" in again.text
    assert person.client.get("/api/next").status_code == 401
    log = admin.query("SELECT actor, detail_json FROM admin_audit WHERE action LIKE 'erase%'")
    assert log[-1][0] == "ada" and person.participant_id not in log[-1][1]


def exported_comments(client: httpx.Client) -> str:
    reply = client.post("/export", data={"csrf": csrf(client)})
    with zipfile.ZipFile(io.BytesIO(reply.content)) as archive:
        return archive.read("mini-export/data/study-mini_table-comments_data.csv").decode()


def test_a_redacted_comment_is_gone_everywhere_and_the_act_is_logged(admin: Server) -> None:
    person = Person.ready(admin)
    words = "my name is Zebulon Quick"
    body = trial_body(person.trial()["trial_id"])
    body["responses"][-1] = response("note", None, words)
    assert person.post("trials", **body).status_code == 201
    again = {**body, "submission_id": new_id()}
    assert person.post("trials", **again).status_code == 409  # kept in the log all the same
    [(number,)] = admin.query("SELECT comment_id FROM comment WHERE body = ?", words)
    form = {"what": "comment", "number": str(number)}
    with visit(admin) as client:
        log_in(client)
        assert words in client.get("/").text and words in exported_comments(client)
        unsaid = client.post("/redact", data={**form, "reason": " ", "csrf": csrf(client)})
        assert "give a reason" in unsaid.text and words in exported_comments(client)
        form["reason"] = "names the participant"
        for wrong in ({"number": "987654"}, {"number": "1 OR 1=1"}, {"what": "participant"}):
            refused = client.post("/redact", data={**form, **wrong, "csrf": csrf(client)})
            assert "Nothing was redacted" in refused.text
        done = client.post("/redact", data={**form, "csrf": csrf(client)})
        assert "its words are gone" in done.text and words not in done.text
        twice = client.post("/redact", data={**form, "csrf": csrf(client)})
        assert "gone already" in twice.text
        export = exported_comments(client)
        assert words not in export and ",[redacted]," in export
    db = Path(admin.db)
    stored = b"".join(path.read_bytes() for path in db.parent.glob(f"{db.name}*"))
    assert b"Zebulon" not in stored
    assert person.post("trials", **body).status_code == 200  # the same letter once more
    log = admin.query("SELECT actor, detail_json FROM admin_audit WHERE action LIKE 'redact%'")
    assert log == [("ada", f'{{"number": {number}, "reason": "names the participant"}}')]
    ratings = admin.query("SELECT count(*) FROM response JOIN trial USING (trial_id) "
                          "WHERE participant_id = ?", person.participant_id)  # fmt: skip
    assert ratings == [(3,)]


def test_the_export_button_gives_the_export(admin: Server) -> None:
    with visit(admin) as client:
        log_in(client)
        reply = client.post("/export", data={"csrf": csrf(client)})
    assert reply.headers["content-type"] == "application/zip"
    with zipfile.ZipFile(io.BytesIO(reply.content)) as archive:
        assert "mini-export/data/study-mini_table-ratings_data.csv" in archive.namelist()


def test_logging_out_ends_the_session(admin: Server) -> None:
    with visit(admin) as client:
        log_in(client)
        kept = client.cookies["verisim_admin"]
        client.post("/logout", data={"csrf": csrf(client)})
        client.cookies.set("verisim_admin", kept)
        assert "Password" in client.get("/").text


def test_guessing_gets_slower() -> None:
    brake = Brake()
    for _ in range(4):
        brake.failed()
    assert brake.wait_s() == 0
    waits = []
    for _ in range(3):
        brake.failed()
        waits.append(round(brake.wait_s()))
    assert waits == [1, 2, 4]
    brake.passed()
    assert brake.wait_s() == 0


def test_passwords_are_hashed_and_long(set_dir: Path, study_path: Path, tmp_path: Path) -> None:
    db = tmp_path / "a.db"
    with at_work_on(study_path, set_dir, db) as connection:
        with pytest.raises(StudyError, match="at least 12"):
            set_password(connection, "ada", "short")
        set_password(connection, "ada", PASSWORD)
    raw = db.read_bytes()
    assert PASSWORD.encode() not in raw and b"$argon2id$" in raw


def test_without_an_account_no_page_is_served(
    set_dir: Path, study_path: Path, tmp_path: Path
) -> None:
    from verisim.study.server import serve

    with pytest.raises(StudyError, match="verisim study admin-password"):
        serve(study_path, set_dir, tmp_path / "n.db", port=0, admin_port=0)
