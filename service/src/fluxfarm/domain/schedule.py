"""The schedule of passes: how many samples per pixel each pass adds.

Sample counts are 1, 1, 2, 4, 8, ... up to a ceiling, so that each early pass doubles what is there and a first whole
picture comes at once. The last pass is cut to the goal. `fluxfarm-engine render` uses the same schedule, which makes
its pixels equal to the service's.
"""

from collections.abc import Iterator
from dataclasses import dataclass

PASS_CEILING_SPP = 64


@dataclass(frozen=True, slots=True)
class SampleRange:
    """Half-open range of sample indices of every pixel."""

    begin: int
    end: int

    @property
    def count(self) -> int:
        """Samples per pixel in this range."""
        return self.end - self.begin


@dataclass(frozen=True, slots=True)
class Round:
    """Samples that some tiles (None: all) take before an error goal is decided again; `number` counts from 1."""

    number: int
    samples: SampleRange
    tiles: tuple[int, ...] | None = None


def next_range(done: int, end: int) -> SampleRange:
    """The samples of the pass that follows when `done` < `end` per pixel are taken, up to `end`."""
    return SampleRange(done, min(done + min(max(done, 1), PASS_CEILING_SPP), end))


def passes(goal_spp: int) -> Iterator[SampleRange]:
    """All passes to `goal_spp` samples per pixel, in order."""
    done = 0
    while done < goal_spp:
        yield (samples := next_range(done, goal_spp))
        done = samples.end


def pass_count(goal_spp: int) -> int:
    """Number of passes to `goal_spp` samples per pixel."""
    return sum(1 for _ in passes(goal_spp))
