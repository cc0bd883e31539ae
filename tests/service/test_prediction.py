"""What a revision foretells of the end of its job."""

from dataclasses import replace

import pytest
from test_ledger import FACTS, GRID, REQUEST, REVISION

from fluxfarm.domain.goal import Goal, Limits
from fluxfarm.domain.job import JobState
from fluxfarm.domain.prediction import predicted_path
from fluxfarm.domain.records import JobRecord, Revision

PIXELS = GRID.crop.area


def record(goal: Goal, state: JobState = JobState.RUNNING, limits: Limits | None = None) -> JobRecord:
    request = replace(REQUEST, goal=goal, limits=limits or Limits())
    return JobRecord("job", state, None, request, 0.0, FACTS, GRID, (), 0, 0, 0, 0, 0, 0.0, 0, 0, None)


def revisions(*rows: tuple[float, float, float | None], expected_spp: float | None = None) -> list[Revision]:
    """(samples per pixel, seconds, error) each; every one decides if `expected_spp` is given."""
    expected = None if expected_spp is None else expected_spp * PIXELS
    return [
        replace(
            REVISION, number=number, mean_samples=spp, running_s=seconds, error_noise=error, samples_expected=expected
        )
        for number, (spp, seconds, error) in enumerate(rows, 1)
    ]


def test_running_job_is_foretold_from_its_newest_revision() -> None:
    start, end = predicted_path(record(Goal(spp=64)), revisions((4, 1.0, 0.4), (16, 4.0, 0.2)))
    assert start == (4.0, 0.2)
    assert end == pytest.approx((16.0, 0.1))


def test_ended_job_is_foretold_from_a_fifth_of_its_samples() -> None:
    told = revisions((4, 1.0, 0.4), (16, 4.0, 0.2), (64, 15.0, 0.11))
    start, end = predicted_path(record(Goal(spp=64), JobState.SUCCEEDED), told)
    assert start == (4.0, 0.2)
    assert end == pytest.approx((16.0, 0.1))


def test_time_goal_ends_at_its_time() -> None:
    _, end = predicted_path(record(Goal(seconds=9.0)), revisions((4, 1.0, 0.3)))
    assert end == pytest.approx((9.0, 0.1))


def test_error_goal_ends_where_the_engine_expects_it() -> None:
    told = revisions((16, 1.0, 0.2), expected_spp=144)
    assert predicted_path(record(Goal(rel_error=0.1)), told)[1] == pytest.approx((9.0, 0.2 / 3))
    undecided = revisions((16, 1.0, 0.2))
    assert predicted_path(record(Goal(rel_error=0.1)), undecided)[1] == pytest.approx((4.0, 0.1))


def test_limit_ends_the_prediction() -> None:
    _, end = predicted_path(record(Goal(rel_error=0.01), limits=Limits(spp=64)), revisions((16, 1.0, 0.2)))
    assert end == pytest.approx((4.0, 0.1))


def test_nothing_is_foretold_without_an_error_or_time_left() -> None:
    assert predicted_path(record(Goal(spp=64)), revisions((1, 1.0, None))) == []
    assert predicted_path(record(Goal(spp=64)), revisions((64, 1.0, 0.1))) == []
