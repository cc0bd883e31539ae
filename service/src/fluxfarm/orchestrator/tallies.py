"""Counts since the start of the service, for the metrics."""

from bisect import bisect_left
from dataclasses import dataclass, field

BUCKETS_S = (0.001, 0.005, 0.02, 0.1, 0.5, 2.0, 10.0)


@dataclass(slots=True)
class Durations:
    """A histogram of durations in seconds, with upper bounds BUCKETS_S and one bucket above."""

    counts: list[int] = field(default_factory=lambda: [0] * (len(BUCKETS_S) + 1))
    total_s: float = 0.0

    def add(self, seconds: float) -> None:
        """Count one duration."""
        self.counts[bisect_left(BUCKETS_S, seconds)] += 1
        self.total_s += seconds


@dataclass(slots=True)
class Tallies:
    """What the orchestrator counts."""

    tiles: int = 0
    stale_tiles: int = 0
    revisions: int = 0
    tile_seconds: Durations = field(default_factory=Durations)
    commit_seconds: Durations = field(default_factory=Durations)
