"""How far a job is and how long it may still take."""

from dataclasses import dataclass

from fluxfarm.domain.goal import Goal


@dataclass(frozen=True, slots=True)
class Progress:
    """Progress of one job. Totals are 0 while unknown; `pass_number` counts from 1, 0 before the first."""

    tiles_done: int
    tiles_total: int
    samples_done: int
    pass_number: int
    error_now: float | None
    eta_seconds: float | None


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
