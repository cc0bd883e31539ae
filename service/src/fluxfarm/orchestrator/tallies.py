"""Counts since the start of the service, for the metrics."""

from bisect import bisect_left
from dataclasses import dataclass, field

SECONDS = (0.001, 0.005, 0.02, 0.1, 0.5, 2.0, 10.0)
LONG_SECONDS = (0.1, 1.0, 10.0, 60.0, 600.0, 3600.0)
ERRORS = (0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5)


@dataclass(slots=True)
class Histogram:
    """How many values lie below each of `bounds`, and in one bucket above them."""

    bounds: tuple[float, ...]
    counts: list[int] = field(init=False)
    total: float = 0.0

    def __post_init__(self) -> None:
        self.counts = [0] * (len(self.bounds) + 1)

    def add(self, value: float) -> None:
        """Count one value."""
        self.counts[bisect_left(self.bounds, value)] += 1
        self.total += value


@dataclass(slots=True)
class Tallies:
    """What the orchestrator counts; `queue_seconds` is from the submission of a job to the beginning of its work,
    `errors` the estimated relative errors that jobs ended with."""

    tiles: int = 0
    stale_tiles: int = 0
    revisions: int = 0
    samples: int = 0
    rays: int = 0
    tile_seconds: Histogram = field(default_factory=lambda: Histogram(SECONDS))
    commit_seconds: Histogram = field(default_factory=lambda: Histogram(SECONDS))
    queue_seconds: Histogram = field(default_factory=lambda: Histogram(LONG_SECONDS))
    errors: Histogram = field(default_factory=lambda: Histogram(ERRORS))
