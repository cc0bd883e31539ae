"""What a job tells its watchers."""

from dataclasses import dataclass
from enum import StrEnum
from typing import Any


class EventKind(StrEnum):
    """Kinds of events, each with the members of its data.

    state: `state`, and `reason` when FAILED. pass: `revision`, `samples`, `error_noise`, `seconds`. tile: `pass`,
    `x`, `y` (tile column and row), `rect`, `seconds`. warning: `message`. end: `state`; the last event of a job.
    """

    STATE = "state"
    PASS = "pass"
    TILE = "tile"
    WARNING = "warning"
    END = "end"


@dataclass(frozen=True, slots=True)
class Event:
    """One event. `seq` counts from 1 without gaps in each job; `at` is Unix time in seconds."""

    seq: int
    kind: EventKind
    at: float
    data: dict[str, Any]
