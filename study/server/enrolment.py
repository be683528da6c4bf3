# SPDX-License-Identifier: MIT
"""A participant arrives: random names, a token, and an order that is planned and stored at once."""

from __future__ import annotations

import hashlib
import hmac
import random
import secrets
from typing import Any

from sqlalchemy import Connection, Row, insert, select, update

from verisim.study.server import tables
from verisim.study.server.adaptive import choose_next_clip
from verisim.study.server.api_error import ApiError
from verisim.study.server.bodies import External, SessionBody
from verisim.study.server.database import utc_now
from verisim.study.server.expected import expected_answer
from verisim.study.server.json_text import to_json
from verisim.study.server.lists import reserve_list, take_list
from verisim.study.server.open_study import OpenStudy
from verisim.study.server.reply import Reply
from verisim.study.server.samplers import PlannedTrial, participant_seed, plan_order
from verisim.study.server.submissions import record_submission

CODE_LETTERS = "ABCDEFGHJKLMNPQRSTUVWXYZ23456789"  # none that is mistaken for another


def hash_token(token: str) -> str:
    return hashlib.sha256(token.encode()).hexdigest()


def choose_source(
    body: SessionBody, source_default: str, simulate_key: str | None, mode: str
) -> str:
    """Returns the participant's source; the key makes simulated, and nothing else does.

    On a pilot server everybody is a pilot; on a live one nobody is.
    """
    source = body.source or source_default
    if source == "simulated" or body.simulate_key is not None:
        given = (body.simulate_key or "").encode(errors="surrogatepass")
        known = simulate_key is not None and hmac.compare_digest(given, simulate_key.encode())
        if not known or source != "simulated":
            raise ApiError(
                403,
                "not_simulated",
                "source `simulated` and simulate_key go together, and the key must be the server's",
                "leave simulate_key out to take part yourself",
            )
        return source
    if body.external is not None:
        source = "link" if body.external.platform == "other" else body.external.platform
    if mode == "pilot":
        return "pilot"
    if mode == "live" and source == "pilot":
        raise ApiError(
            403,
            "no_pilot_here",
            "this server collects live data; pilots have a server of their own",
            "serve the study with --pilot and another --db",
        )
    return source


def enrol(connection: Connection, opened: OpenStudy, body: SessionBody, source: str) -> Reply:
    """Creates participant, order and session; the token is in the reply and nowhere else."""
    known = select(tables.submission.c.submission_id).where(
        tables.submission.c.submission_id == body.submission_id
    )
    if connection.execute(known).first() is not None:
        raise ApiError(
            409,
            "duplicate_session",
            "this submission_id has already opened a session; its token is not kept",
            "open a new session with a new submission_id",
        )
    now = utc_now()
    check_open(connection)
    invitation = use_link(connection, opened.study.links, body, source)
    if invitation is not None and source not in ("simulated", "pilot", "prolific", "mturk"):
        source = invitation.source
    cell, list_no = take_list(connection, opened, now)
    participant_id, session_id = f"p{secrets.token_hex(12)}", f"s{secrets.token_hex(12)}"
    token = secrets.token_urlsafe(32)
    seed = participant_seed(opened.study.order.seed, list_no, cell)
    connection.execute(
        insert(tables.participant).values(
            participant_id=participant_id,
            study_id=opened.study.name,
            source=source,
            state="enrolled",
            completion_code=_completion_code(),
            enrolled_utc=now,
            cell=cell,
            buttons=random.Random(f"{seed}:buttons").choice(("normal", "reversed")),
            invitation_id=invitation.invitation_id if invitation else None,
        )
    )
    if body.external is not None:
        link_outside_id(connection, participant_id, body.external)
    _assign_order(connection, opened, participant_id, cell, list_no, seed)
    reserve_list(connection, opened, participant_id, cell, list_no, now)
    env = body.environment
    connection.execute(
        insert(tables.session).values(
            session_id=session_id,
            participant_id=participant_id,
            token_sha256=hash_token(token),
            started_utc=now,
            last_seen_utc=now,
            app_version=env.app_version,
            browser=env.browser,
            browser_version=env.browser_version,
            os=env.os,
            is_mobile=int(env.is_mobile),
            screen_w_px=env.screen_w,
            screen_h_px=env.screen_h,
            viewport_w_px=env.viewport_w,
            viewport_h_px=env.viewport_h,
            device_pixel_ratio=env.device_pixel_ratio,
            refresh_hz=env.refresh_hz,
            language=env.language,
            tz_offset_min=env.tz_offset_min,
        )
    )
    choose_next_clip(connection, opened, participant_id)
    # Keys and outside ids have their own place, or none: they stay out of the log.
    hidden = {"simulate_key": None, "external": None, "link": None}
    logged = body.model_copy(update=hidden).model_dump_json().encode()
    record_submission(connection, session_id, body.submission_id, "session", logged, "stored", now)
    reply = {"token": token, "participant_id": participant_id, "session_id": session_id}
    return Reply(201, reply)


def check_open(connection: Connection) -> None:
    """Refuses newcomers while the study is paused or closed."""
    state = connection.scalar(select(tables.study.c.state))
    if state != "open":
        raise ApiError(
            403,
            f"study_{state}",
            f"the study is {state} to new participants",
            "come back later" if state == "paused" else "ask the person in charge",
        )


def use_link(connection: Connection, links: str, body: SessionBody, source: str) -> Row[Any] | None:
    """Returns the participant link that was followed, one use of it taken."""
    if body.link is None:
        if links == "required" and source != "simulated":
            raise ApiError(403, "link_needed", "this study needs a link of your own", "ask for one")
        return None
    invitation = tables.invitation.c
    row = connection.execute(
        select(tables.invitation).where(invitation.token_sha256 == hash_token(body.link))
    ).first()
    if row is None:
        raise ApiError(403, "link_unknown", "this link is not known", "check that it is whole")
    if row.state == "closed":
        raise ApiError(403, "link_closed", "this link was closed", "ask the person in charge")
    if row.max_uses is not None and row.num_uses >= row.max_uses:
        raise ApiError(
            403, "link_used", "this link was used before", "go on in the browser you began with"
        )
    connection.execute(
        update(tables.invitation)
        .where(invitation.invitation_id == row.invitation_id)
        .values(num_uses=row.num_uses + 1)
    )
    return row


def link_outside_id(connection: Connection, participant_id: str, external: External) -> None:
    """Stores who somebody is elsewhere; nobody takes part twice."""
    link = tables.participant_link.c
    known = select(link.participant_id).where(
        link.platform == external.platform, link.external_id == external.participant
    )
    if connection.execute(known).first() is not None:
        raise ApiError(
            403,
            "already_taken_part",
            "somebody with this identifier has taken part before",
            "go on in the browser you began with",
        )
    connection.execute(
        insert(tables.participant_link).values(
            participant_id=participant_id,
            platform=external.platform,
            external_id=external.participant,
            external_study=external.study,
            external_session=external.session,
        )
    )


def _completion_code() -> str:
    letters = "".join(secrets.choice(CODE_LETTERS) for _ in range(10))
    return f"{letters[:5]}-{letters[5:]}"


def _assign_order(
    connection: Connection,
    opened: OpenStudy,
    participant_id: str,
    cell: str,
    list_no: int,
    seed: str,
) -> None:
    order = opened.study.order
    layouts = opened.study.trial.layouts
    plan = plan_order(order, opened.stimulus_set.stimuli, layouts, seed, list_no, cell)
    connection.execute(
        insert(tables.assignment).values(
            participant_id=participant_id,
            algorithm=order.sampler.name,
            list_no=list_no,
            seed=seed,
            order_sha256=order_sha256(plan),
        )
    )
    connection.execute(insert(tables.trial), _trial_rows(opened, participant_id, plan))


def order_sha256(plan: list[PlannedTrial]) -> str:
    """Returns the hash that shows later that an order is the one its seed gives."""
    return hashlib.sha256("".join(trial.line() for trial in plan).encode()).hexdigest()


def _trial_rows(
    opened: OpenStudy, participant_id: str, plan: list[PlannedTrial]
) -> list[dict[str, Any]]:
    """Numbers the trials; block 0 is practice, then a new block begins after each rest."""
    study = opened.study
    num_practice = sum(trial.trial_kind == "practice" for trial in plan)
    rows = []
    for i, trial in enumerate(plan):
        is_practice = trial.trial_kind == "practice"
        rest_every = study.trial.rest_every or len(plan)
        clips = [opened.stimulus_ids[name] for name in trial.clips]
        expected = expected_answer(study, trial) if clips else None
        rows.append(
            {
                "participant_id": participant_id,
                "trial_index": i,
                "block": 0 if is_practice else 1 + (i - num_practice) // rest_every,
                "trial_kind": trial.trial_kind,
                "layout": trial.layout,
                "stimulus_a": clips[0] if clips else None,
                "stimulus_b": clips[1] if len(clips) == 2 else None,
                "expected_json": to_json(expected) if expected else None,
                "track": trial.track or None,
            }
        )
    return rows
