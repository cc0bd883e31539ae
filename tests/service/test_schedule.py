"""The schedule of passes and the decision to stop."""

from itertools import pairwise

from hypothesis import given
from hypothesis import strategies as st

from fluxfarm.domain.goal import Goal, Limits, Measured, Stop, has_barriers, next_pass, settled
from fluxfarm.domain.schedule import PASS_CEILING_SPP, pass_count, pass_samples, passes

NO_LIMITS = Limits()


def test_hundred_samples_are_cut_as_the_engine_cuts_them() -> None:
    assert [samples.count for samples in passes(100)] == [1, 1, 2, 4, 8, 16, 32, 36]


@given(st.integers(1, 20_000))
def test_passes_cover_each_sample_exactly_once(goal: int) -> None:
    ranges = list(passes(goal))
    assert ranges[0].begin == 0
    assert ranges[-1].end == goal
    assert all(before.end == after.begin for before, after in pairwise(ranges))
    assert all(0 < samples.count <= PASS_CEILING_SPP for samples in ranges)
    assert len(ranges) == pass_count(goal)


@given(st.integers(2, 6))
def test_early_passes_double_what_is_there(index: int) -> None:
    assert pass_samples(index) == sum(pass_samples(before) for before in range(index))


@given(st.integers(1, 5000))
def test_sample_goal_takes_exactly_its_samples(goal: int) -> None:
    done = taken = 0
    while not isinstance(step := next_pass(Goal(spp=goal), NO_LIMITS, Measured(taken, done, 1.0, None, None)), Stop):
        done, taken = step.end, taken + 1
    assert done == goal
    assert step.warning is None


@given(st.floats(0.1, 1000), st.floats(0.001, 100))
def test_time_goal_is_never_overshot_by_more_than_a_sample(seconds: float, sample_s: float) -> None:
    done = taken = 0
    while not isinstance(
        step := next_pass(Goal(seconds=seconds), NO_LIMITS, Measured(taken, done, done * sample_s, None, None)), Stop
    ):
        done, taken = step.end, taken + 1
    assert done >= 1
    assert done * sample_s <= max(seconds, sample_s) + sample_s


def test_error_goal_stops_when_the_bound_meets_it_and_not_when_only_the_estimate_does() -> None:
    goal = Goal(rel_error=0.1)
    assert isinstance(next_pass(goal, NO_LIMITS, Measured(6, 32, 1.0, 0.08, 0.09)), Stop)
    assert not isinstance(next_pass(goal, NO_LIMITS, Measured(6, 32, 1.0, 0.09, 0.11)), Stop)
    assert not isinstance(next_pass(goal, NO_LIMITS, Measured(6, 48, 1.0, 0.001, None)), Stop)


def test_limit_that_ends_a_job_early_says_so() -> None:
    step = next_pass(Goal(rel_error=0.001), Limits(spp=64), Measured(7, 64, 2.0, 0.2, 0.25))
    assert isinstance(step, Stop)
    assert step.warning is not None
    assert "0.2" in step.warning
    assert "0.001" in step.warning


def test_absent_goal_is_the_scenes_own_sample_count() -> None:
    assert settled(Goal(), 12) == Goal(spp=12)
    assert settled(Goal(), 0) == Goal(spp=64)
    assert settled(Goal(seconds=3), 12) == Goal(seconds=3)


def test_only_sample_goals_without_time_limit_go_on_without_barriers() -> None:
    assert not has_barriers(Goal(spp=8), NO_LIMITS)
    assert has_barriers(Goal(spp=8), Limits(seconds=1))
    assert has_barriers(Goal(rel_error=0.1), NO_LIMITS)
