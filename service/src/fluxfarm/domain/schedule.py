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


def pass_samples(index: int) -> int:
    """Samples per pixel of the pass `index` (0, 1, 2 ...) when nothing cuts it."""
    if index <= 1:
        return 1
    return min(1 << min(index - 1, PASS_CEILING_SPP.bit_length()), PASS_CEILING_SPP)


def next_range(index: int, samples_done: int, goal_spp: int) -> SampleRange | None:
    """The samples of the pass `index` after `samples_done` per pixel, cut to `goal_spp`; None when all are taken."""
    if samples_done >= goal_spp:
        return None
    return SampleRange(samples_done, min(samples_done + pass_samples(index), goal_spp))


def passes(goal_spp: int) -> Iterator[SampleRange]:
    """All passes to `goal_spp` samples per pixel, in order."""
    index, done = 0, 0
    while (samples := next_range(index, done, goal_spp)) is not None:
        yield samples
        index, done = index + 1, samples.end


def pass_count(goal_spp: int) -> int:
    """Number of passes to `goal_spp` samples per pixel."""
    return sum(1 for _ in passes(goal_spp))
