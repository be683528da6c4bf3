# SPDX-License-Identifier: MIT
"""The data-protection note of the consent form, made from what the study really stores."""

from __future__ import annotations

from collections.abc import Sequence

from verisim.study.server import tables
from verisim.study.server.questions import Question
from verisim.study.server.study_parts import ScreenRules

# Each part: the table and columns it speaks of, and its words. A test checks that every column of
# a table with participants' data is spoken of here.
PARTS: dict[str, tuple[str, str, str]] = {
    "participant": (
        "participant_id completion_code enrolled_utc completed_utc state source cell buttons"
        " invitation_id study_id",
        "a random code for you, how far you came, when you began and ended, and which of several "
        "versions of the study you saw",
        "ein Zufallscode für Sie, wie weit Sie kamen, Beginn und Ende, und welche Fassung der "
        "Studie Sie sahen",
    ),
    "participant_link": (
        "participant_id platform external_id external_study external_session",
        "only if you come from a recruiting platform: the identifiers it sends along, in a table "
        "of their own that is erased first",
        "nur wenn Sie über eine Vermittlungsplattform kommen: deren Kennungen, in einer eigenen "
        "Tabelle, die zuerst gelöscht wird",
    ),
    "consent": (
        "consent_id participant_id form_version form_sha256 language agreed answered_utc",
        "your decision on this form, its version and language, and when you made it",
        "Ihre Entscheidung zu diesem Formular, dessen Fassung und Sprache, und wann sie fiel",
    ),
    "assignment": (
        "participant_id algorithm list_no seed order_sha256",
        "the order in which clips are shown to you",
        "die Reihenfolge, in der Ihnen Filme gezeigt werden",
    ),
    "session": (
        "session_id participant_id token_sha256 started_utc last_seen_utc ended_utc app_version"
        " browser browser_version os is_mobile screen_w_px screen_h_px viewport_w_px viewport_h_px"
        " device_pixel_ratio refresh_hz language tz_offset_min",
        "kind and version of browser and system, size, pixel density and refresh rate of the "
        "screen, and the language and time zone that the browser reports",
        "Art und Version von Browser und System, Größe, Pixeldichte und Bildrate des Bildschirms, "
        "sowie Sprache und Zeitzone, die der Browser meldet",
    ),
    "screen_check": (
        "check_id session_id verdict problems_json codec_plays fullscreen refresh_hz viewport_w_px"
        " viewport_h_px calibration_skipped checked_utc",
        "whether your screen can show the clips",
        "ob Ihr Bildschirm die Filme zeigen kann",
    ),
    "trial": (
        "trial_id participant_id trial_index block trial_kind layout stimulus_a stimulus_b"
        " expected_json answered_utc track",
        "which clips you were shown",
        "welche Filme Ihnen gezeigt wurden",
    ),
    "presentation": (
        "presentation_id trial_id session_id num_plays onset_ms first_frame_ms ended_ms"
        " frames_total frames_dropped stall_count stall_ms hidden_ms fullscreen displayed_w_px"
        " displayed_h_px completed received_utc device_pixel_ratio scale num_mark_plays blur_count"
        " fullscreen_exits start_skew_ms",
        "how each clip played: size, pictures skipped, interruptions, and whether the page was in "
        "view and in front",
        "wie jeder Film lief: Größe, ausgelassene Bilder, Unterbrechungen, und ob die Seite "
        "sichtbar und vorne war",
    ),
    "presentation_clip": (
        "presentation_id position stimulus_id num_plays onset_ms first_frame_ms ended_ms"
        " frames_total frames_dropped stall_count stall_ms",
        "",
        "",
    ),
    "response": (
        "response_id presentation_id trial_id question_id value value_text rt_ms rt_origin"
        " first_touch_ms num_changes answered_utc item rt_onset_ms reversed",
        "your answers, how long they took, and how often you changed them",
        "Ihre Antworten, wie lange sie dauerten und wie oft Sie sie änderten",
    ),
    "session_answer": (
        "answer_id participant_id session_id question_id item value value_text rt_ms num_changes"
        " reversed answered_utc",
        "",
        "",
    ),
    "comment": (
        "comment_id presentation_id trial_id question_id body rt_ms redacted answered_utc",
        "what you write in comments; please write nothing there that tells who you are",
        "was Sie in Kommentare schreiben; bitte nichts, was verrät, wer Sie sind",
    ),
    "event": (
        "session_id seq presentation_id kind t_ms detail_json",
        "what happened on the page, such as leaving full screen",
        "was auf der Seite geschah, etwa das Verlassen des Vollbilds",
    ),
    "submission": (
        "submission_id session_id kind outcome body body_sha256 received_utc",
        "all of this a second time as it was sent, as a safeguard against loss",
        "all das ein zweites Mal, wie es gesendet wurde, als Schutz vor Verlust",
    ),
}
CALIBRATION = "css_px_per_mm viewing_distance_mm px_per_degree"  # of session and screen_check

HEAD = {
    "en": "**What the database of this study holds about you.**",
    "de": "**Was die Datenbank dieser Studie über Sie enthält.**",
}
TAIL = {
    "en": "No name, no address and no internet address (IP) is stored. Your browser keeps a random "
    "key on your device so that you can go on after an interruption. The last page shows a link "
    "with which you can have everything about you deleted at once.",
    "de": "Nicht gespeichert werden Name, Anschrift und Internetadresse (IP). Ihr Browser bewahrt "
    "einen Zufallsschlüssel auf Ihrem Gerät auf, damit Sie nach einer Unterbrechung weitermachen "
    "können. Die letzte Seite zeigt einen Link, mit dem Sie alles über Sie sofort löschen können.",
}
SCREEN_SIZE = {
    "en": "the size of your screen in millimetres and your distance from it, if you measure them",
    "de": "die Größe Ihres Bildschirms in Millimetern und Ihr Abstand davon, wenn Sie sie messen",
}


def data_note(
    language: str, screen: ScreenRules | None, questions: Sequence[Question], links: str
) -> str:
    """Returns the note as Markdown: a list of what is stored, for this study alone.

    A language without words of our own gets the English note.
    """
    del links  # a participant link adds nothing that identifies anybody
    words = language if language in HEAD else "en"
    skipped = set()
    if screen is None:
        skipped.add("screen_check")
    if not any(question.is_free_text for question in questions):
        skipped.add("comment")
    lines = [
        english if words == "en" else german
        for table, (_, english, german) in PARTS.items()
        if table not in skipped and english
    ]
    if screen is not None and screen.calibration != "off":
        lines.append(SCREEN_SIZE[words])
    listed = "\n".join(f"* {line}" for line in lines)
    return f"{HEAD[words]}\n\n{listed}\n\n{TAIL[words]}"


def columns_told() -> dict[str, set[str]]:
    """Returns, by table, the columns that the note speaks of."""
    told = {table: set(columns.split()) for table, (columns, _, _) in PARTS.items()}
    for table in ("session", "screen_check"):
        told[table] |= set(CALIBRATION.split())
    return told


def columns_stored() -> dict[str, set[str]]:
    """Returns, by table, the columns of everything that goes when a participant is erased."""
    reached = {"participant"}
    while True:
        more = {
            table.name
            for table in tables.metadata.sorted_tables
            for key in table.foreign_keys
            if key.ondelete == "CASCADE" and key.column.table.name in reached
        }
        if more <= reached:
            break
        reached |= more
    return {name: set(tables.metadata.tables[name].columns.keys()) for name in reached}
