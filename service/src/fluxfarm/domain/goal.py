"""When a job has enough samples: by count, by time or by error.

A sample goal fixes all passes in advance. A time goal decides before each pass, from the clock. An error goal is
decided by the engine after each round of passes, from the merged sums alone, so that the same job always stops at the
same samples: the engine bounds the error, with a confidence that it spends over the rounds, and names the tiles that
need more.
"""

from dataclasses import dataclass

from fluxfarm.domain.schedule import Round, SampleRange, next_range

DEFAULT_SPP = 64
# An error goal that is never reached has to end somewhere.
ERROR_GOAL_CEILING_SPP = 65_536
# Samples of the first round of an error goal, and the side of its tiles in pixels: as in engine/src/film/error_goal.h.
FIRST_ROUND_SPP = 16
ERROR_TILE = 32
UNBOUNDED_SPP = 1 << 31
# A time goal stops when less than this share of the next sample would fit.
LEAST_FITTING_SHARE = 0.5


@dataclass(frozen=True, slots=True)
class Goal:
    """At most one of the three is set; none means the scene's own sample count, else DEFAULT_SPP."""

    rel_error: float | None = None
    spp: int | None = None
    seconds: float | None = None


@dataclass(frozen=True, slots=True)
class Limits:
    """Bounds that end a job early, with a warning when its goal was not reached. `seconds` count from RUNNING on."""

    spp: int | None = None
    seconds: float | None = None


@dataclass(frozen=True, slots=True)
class Measured:
    """What is known when a pass may begin.

    `round` is None once an error goal needs no further one. `spp` are the samples taken of each of its pixels,
    `sample_s` the seconds that one more of each will take by the rate so far (0: unknown). `error_bound` is there at a
    decision, and `unseen_warning` at one that ends the job because paths cannot find all of its light, or claims the
    goal without an audit."""

    round: Round | None
    spp: int
    running_s: float
    sample_s: float
    error_noise: float | None
    error_bound: float | None
    unseen_warning: str | None = None


@dataclass(frozen=True, slots=True)
class Stop:
    """The job has its samples. `warning` tells the owner why the goal was not reached, or what its claim rests on."""

    warning: str | None = None


def settled(goal: Goal, scene_spp: int) -> Goal:
    """`goal` with an absent goal replaced by the scene's own sample count (0: it has none) or the default."""
    if goal.rel_error is None and goal.spp is None and goal.seconds is None:
        return Goal(spp=scene_spp or DEFAULT_SPP)
    return goal


def has_barriers(goal: Goal, limits: Limits) -> bool:
    """Whether each pass has to be merged before the next one is chosen."""
    return goal.seconds is not None or limits.seconds is not None


def ceiling_spp(goal: Goal, limits: Limits) -> int | None:
    """Most samples per pixel that the job can take; None when only time bounds it."""
    if goal.spp is not None:
        return min(goal.spp, limits.spp or goal.spp)
    if goal.rel_error is not None:
        return limits.spp or ERROR_GOAL_CEILING_SPP
    return limits.spp


def first_round(goal: Goal, limits: Limits) -> Round:
    """The round with which a job begins; the only one unless it has an error goal. `goal` is settled."""
    ceiling = ceiling_spp(goal, limits) or UNBOUNDED_SPP
    end = ceiling if goal.rel_error is None else min(FIRST_ROUND_SPP, ceiling)
    return Round(1, SampleRange(0, end))


def next_pass(goal: Goal, limits: Limits, measured: Measured) -> SampleRange | Stop:
    """The samples of the next pass of the round, or Stop. `goal` is settled."""
    if measured.round is None or measured.spp >= measured.round.samples.end:
        return Stop(_warning(goal, measured))
    samples = next_range(measured.spp, measured.round.samples.end)
    seconds = min((s for s in (goal.seconds, limits.seconds) if s is not None), default=None)
    if seconds is None or measured.sample_s <= 0:
        return samples
    fitting = (seconds - measured.running_s) / measured.sample_s
    if fitting < LEAST_FITTING_SHARE:
        return Stop(_warning(goal, measured))
    return SampleRange(samples.begin, samples.begin + max(1, min(samples.count, int(fitting))))


def _warning(goal: Goal, measured: Measured) -> str | None:
    """Why stopping now misses the goal or what its claim rests on, or None if there is nothing to say."""
    if goal.rel_error is not None:
        if measured.unseen_warning is not None:
            return measured.unseen_warning
        if measured.error_bound is not None and measured.error_bound <= goal.rel_error:
            return None
        error = "unknown" if measured.error_noise is None else f"{measured.error_noise:.4g}"
        return (
            f"goal not reached with 95 % confidence: the error is about {error} after at most {measured.spp} samples "
            f"a pixel and {measured.running_s:.1f} s, expected at most {goal.rel_error:g}; raise the limits"
        )
    if goal.spp is not None and measured.spp < goal.spp:
        return (
            f"goal not reached: {measured.spp} samples per pixel after {measured.running_s:.1f} s, "
            f"expected {goal.spp}; raise the limits"
        )
    return None
