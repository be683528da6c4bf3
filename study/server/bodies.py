# SPDX-License-Identifier: MIT
"""The bodies that the page may send, strictly: nothing unknown, nothing unbounded."""

from __future__ import annotations

from typing import Annotated, Literal, TypeVar

from pydantic import AfterValidator, BaseModel, ConfigDict, Field, ValidationError

from verisim.study.server.api_error import ApiError

MAX_INTEGER = 2**53 - 1  # the largest that JavaScript counts exactly
MAX_MS = 1e9
MAX_EVENTS = 500
MAX_FAULTS_SHOWN = 10


def refuse_control(text: str) -> str:
    """Refuses characters that no keyboard makes: they would poison the exported tables."""
    for character in text:
        if (character < " " and character not in "\n\r\t") or character == "\x7f":
            raise ValueError(f"control character U+{ord(character):04X} is not allowed")
    return text


Id = Annotated[str, Field(pattern=r"^[A-Za-z0-9_-]{8,64}$")]
Name = Annotated[str, Field(pattern=r"^[a-z][a-z0-9_]{0,39}$")]
Label = Annotated[str, Field(max_length=120), AfterValidator(refuse_control)]
Words = Annotated[str, Field(max_length=2000), AfterValidator(refuse_control)]
Ms = Annotated[float, Field(ge=0, le=MAX_MS)]
Count = Annotated[int, Field(ge=0, le=MAX_INTEGER)]
Pixels = Annotated[int, Field(ge=0, le=100_000)]
Length = Annotated[float, Field(ge=0, le=100_000)]
PixelRatio = Annotated[float, Field(ge=0.01, le=100)]  # browsers zoom out to a quarter
Scalar = (
    bool
    | Annotated[int, Field(ge=-MAX_INTEGER, le=MAX_INTEGER)]
    | Annotated[float, Field(ge=-1e15, le=1e15)]
    | Annotated[str, Field(max_length=500), AfterValidator(refuse_control)]
    | None
)


class Body(BaseModel):
    model_config = ConfigDict(strict=True, extra="forbid", allow_inf_nan=False, frozen=True)

    submission_id: Id


class Part(BaseModel):
    model_config = ConfigDict(strict=True, extra="forbid", allow_inf_nan=False, frozen=True)


class Environment(Part):
    browser: Label
    browser_version: Label
    os: Label
    is_mobile: bool
    screen_w: Pixels
    screen_h: Pixels
    viewport_w: Pixels
    viewport_h: Pixels
    device_pixel_ratio: PixelRatio
    refresh_hz: Annotated[float, Field(gt=0, le=2000)] | None
    language: Label
    tz_offset_min: Annotated[int, Field(ge=-1440, le=1440)]
    app_version: Label


class External(Part):
    """Who somebody is on a recruiting platform."""

    platform: Literal["prolific", "mturk", "other"]
    participant: Annotated[str, Field(pattern=r"^[A-Za-z0-9_.@-]{1,100}$")]
    study: Annotated[str, Field(pattern=r"^[A-Za-z0-9_.@-]{0,100}$")] | None
    session: Annotated[str, Field(pattern=r"^[A-Za-z0-9_.@-]{0,100}$")] | None


class SessionBody(Body):
    source: Literal["link", "lab", "pilot", "simulated"] | None = None
    simulate_key: Annotated[str, Field(max_length=200)] | None = None
    environment: Environment
    link: Annotated[str, Field(max_length=200), AfterValidator(refuse_control)] | None = None
    external: External | None = None


class ConsentBody(Body):
    agreed: bool
    form_version: Label
    form_sha256: Annotated[str, Field(pattern=r"^[0-9a-f]{64}$")]
    language: Annotated[str, Field(pattern=r"^[a-z]{2,3}$")]


class InstructionsBody(Body):
    pass


class ScreenBody(Body):
    environment: Environment
    codec_plays: bool | None
    fullscreen: bool
    refresh_hz: Annotated[float, Field(gt=0, le=2000)] | None
    css_px_per_mm: Annotated[float, Field(ge=0.5, le=50)] | None
    viewing_distance_mm: Annotated[float, Field(ge=100, le=5000)] | None
    calibration_skipped: bool = False


class Played(Part):
    """What the screen did: of a whole showing, or of one of its clips."""

    num_plays: Annotated[int, Field(ge=0, le=1000)]
    onset_ms: Ms | None
    first_frame_ms: Ms | None
    ended_ms: Ms | None
    frames_total: Count | None
    frames_dropped: Count | None
    stall_count: Count
    stall_ms: Ms


class ShownClip(Played):
    position: Literal[0, 1]
    sha256: Annotated[str, Field(pattern=r"^[0-9a-f]{64}$")]


class Presentation(Played):
    presentation_id: Id
    hidden_ms: Ms
    fullscreen: bool
    displayed_w: Length
    displayed_h: Length
    completed: bool
    device_pixel_ratio: PixelRatio | None = None
    scale: Annotated[int, Field(ge=0, le=100)] | None = None
    num_mark_plays: Annotated[int, Field(ge=0, le=1000)] = 0
    blur_count: Count = 0
    fullscreen_exits: Count = 0
    start_skew_ms: Annotated[float, Field(ge=-MAX_MS, le=MAX_MS)] | None = None
    clips: Annotated[list[ShownClip], Field(max_length=2)] = []


class Response(Part):
    question: Name
    value: Annotated[float, Field(ge=-1e9, le=1e9)] | None
    value_text: Words | None
    rt_ms: Ms
    rt_origin: Literal["video_onset", "video_end", "form_shown"]
    first_touch_ms: Ms | None
    num_changes: Count
    item: Annotated[str, Field(pattern=r"^([A-Za-z][A-Za-z0-9_]{0,39})?$")] = ""
    rt_onset_ms: Ms | None = None
    reversed: bool = False


class TrialBody(Body):
    trial_id: Annotated[int, Field(ge=1, le=MAX_INTEGER)]
    presentation: Presentation
    responses: Annotated[list[Response], Field(max_length=100)]


class PresentationBody(Body):
    trial_id: Annotated[int, Field(ge=1, le=MAX_INTEGER)]
    presentation: Presentation


class EndBody(Body):
    responses: Annotated[list[Response], Field(max_length=200)]


class StopBody(Body):
    pass


class WithdrawBody(Body):
    confirm: Literal[True]


class WithdrawByLinkBody(Body):
    withdrawal: Annotated[str, Field(pattern=r"^[A-Za-z0-9_.-]{20,200}$")]


class Event(Part):
    seq: Count
    presentation_id: Id | None
    kind: Name
    t_ms: Ms
    detail: Annotated[dict[Name, Scalar], Field(max_length=30)] | None


class EventsBody(Body):
    events: Annotated[list[Event], Field(min_length=1, max_length=MAX_EVENTS)]


SomeBody = TypeVar("SomeBody", bound=Body)


def parse_body(model: type[SomeBody], raw: bytes) -> SomeBody:
    """Returns the checked body. Raises ApiError 422: what is wrong and where, without values."""
    try:
        return model.model_validate_json(raw)
    except ValidationError as error:
        faults = [
            f"{'.'.join(str(part) for part in fault['loc']) or 'body'}: {fault['msg']}"
            for fault in error.errors(include_input=False, include_url=False, include_context=False)
        ]
        more = len(faults) - MAX_FAULTS_SHOWN
        text = "; ".join(faults[:MAX_FAULTS_SHOWN]) + (f"; and {more} more" if more > 0 else "")
        raise ApiError(
            422, "invalid", text, "send exactly the fields of the HTTP contract"
        ) from error
