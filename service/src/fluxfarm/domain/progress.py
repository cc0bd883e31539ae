"""How far a job is and how long it may still take."""

import math
from dataclasses import dataclass

from fluxfarm.domain.goal import Goal
from fluxfarm.domain.records import Revision

# The square of the error falls with the samples to this power at least (random samples) and at most (stratified ones).
SLOWEST_FALL, FASTEST_FALL = 1.0, 2.0


@dataclass(frozen=True, slots=True)
class Progress:
    """Progress of one job. Totals are 0 while unknown; `pass_number` counts from 1, 0 before the first."""

    tiles_done: int
    tiles_total: int
    samples_done: int
    pass_number: int
    error_now: float | None
    eta_seconds: float | None


def samples_expected(before: Revision | None, decision: Revision, pixels: int) -> float | None:
    """Camera samples of a whole job of `pixels` pixels with an error goal, as of its newest decision.

    The engine takes variances to fall as 1 / samples. Stratified samples do better, and few samples let dark places
    look worse than they are: how much faster the bound fell since the decision `before` is taken to go on."""
    if decision.samples_expected is None or before is None:
        return decision.samples_expected
    taken = decision.mean_samples * pixels
    growth = decision.mean_samples / max(before.mean_samples, 1.0)
    if growth <= 1 or not before.error_bound or not decision.error_bound or math.isinf(before.error_bound):
        return decision.samples_expected
    fall = 2 * math.log(before.error_bound / decision.error_bound) / math.log(growth)
    fall = min(max(fall, SLOWEST_FALL), FASTEST_FALL)
    return float(taken * max(decision.samples_expected / taken, 1.0) ** (1 / fall))


def eta_seconds(
    goal: Goal,
    spp: float,
    running_s: float,
    error_now: float | None,
    ceiling: int | None,
    expected_spp: float | None = None,
) -> float | None:
    """Seconds until `goal` is reached at the rate so far, or None when that cannot be told yet.

    `spp` are the samples per pixel taken so far (a mean over the frame), `ceiling` the most that will be taken. For an
    error goal `expected_spp` is what its last decision expects; before the first, the error is taken to fall with the
    square root of the samples.
    """
    if goal.seconds is not None:
        return max(0.0, goal.seconds - running_s)
    if spp <= 0 or running_s <= 0:
        return None
    wanted: float | None = goal.spp
    if goal.rel_error is not None and expected_spp is not None:
        wanted = expected_spp
    elif goal.rel_error is not None:
        if error_now is None:
            return None
        wanted = spp * (error_now / goal.rel_error) ** 2
    if wanted is None:
        return None
    if ceiling is not None:
        wanted = min(wanted, ceiling)
    return max(0.0, (wanted - spp) * running_s / spp)
