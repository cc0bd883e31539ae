"""The schedule of passes and the decision to stop."""

from itertools import pairwise

from hypothesis import given
from hypothesis import strategies as st

from fluxfarm.domain.goal import Goal, Limits, Measured, Stop, first_round, has_barriers, next_pass, settled
from fluxfarm.domain.schedule import PASS_CEILING_SPP, Round, SampleRange, next_range, pass_count, passes

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


@given(st.integers(0, 6))
def test_early_passes_double_what_is_there(power: int) -> None:
    assert next_range(1 << power, 1 << 20) == SampleRange(1 << power, 2 << power)


def measured(goal: Goal, spp: int, running_s: float, sample_s: float) -> Measured:
    """State of a job without an error goal after `spp` samples per pixel."""
    return Measured(first_round(goal, NO_LIMITS), spp, running_s, sample_s, None, None)


@given(st.integers(1, 5000))
def test_sample_goal_takes_exactly_its_samples(spp: int) -> None:
    goal, done = Goal(spp=spp), 0
    while not isinstance(step := next_pass(goal, NO_LIMITS, measured(goal, done, 1.0, 0.0)), Stop):
        done = step.end
    assert done == spp
    assert step.warning is None


@given(st.floats(0.1, 1000), st.floats(0.001, 100))
def test_time_goal_is_never_overshot_by_more_than_a_sample(seconds: float, sample_s: float) -> None:
    goal, done = Goal(seconds=seconds), 0
    while not isinstance(
        step := next_pass(goal, NO_LIMITS, measured(goal, done, done * sample_s, sample_s if done else 0.0)), Stop
    ):
        done = step.end
    assert done >= 1
    assert done * sample_s <= max(seconds, sample_s) + sample_s


def test_error_goal_begins_with_a_round_of_sixteen_samples_everywhere() -> None:
    assert first_round(Goal(rel_error=0.1), NO_LIMITS) == Round(1, SampleRange(0, 16))
    assert first_round(Goal(rel_error=0.1), Limits(spp=5)) == Round(1, SampleRange(0, 5))


def test_error_goal_without_a_further_round_is_reached_by_its_bound_and_not_by_its_estimate() -> None:
    goal = Goal(rel_error=0.1)
    assert next_pass(goal, NO_LIMITS, Measured(None, 32, 1.0, 0.1, 0.08, 0.09)) == Stop()
    missed = next_pass(goal, NO_LIMITS, Measured(None, 64, 2.0, 0.1, 0.08, 0.11))
    assert isinstance(missed, Stop)
    assert missed.warning is not None
    assert "0.08" in missed.warning
    assert "0.1;" in missed.warning


def test_goal_that_light_out_of_reach_keeps_from_being_met_is_explained_by_the_engine() -> None:
    goal = Goal(rel_error=0.1)
    why = "goal not reached: light that path tracing cannot find"
    assert next_pass(goal, NO_LIMITS, Measured(None, 64, 2.0, 0.1, 0.08, 0.5, why)) == Stop(why)


def test_claim_without_an_audit_says_so() -> None:
    why = "claimed from noise alone"
    assert next_pass(Goal(rel_error=0.1), NO_LIMITS, Measured(None, 64, 2.0, 0.1, 0.08, 0.09, why)) == Stop(why)


def test_limit_of_time_ends_a_round_early_and_says_so() -> None:
    late = Measured(Round(3, SampleRange(64, 128), (1,)), 64, 9.8, 1.0, 0.2, None)
    step = next_pass(Goal(rel_error=0.001), Limits(seconds=10), late)
    assert isinstance(step, Stop)
    assert step.warning is not None
    assert "0.001" in step.warning


def test_absent_goal_is_the_scenes_own_sample_count() -> None:
    assert settled(Goal(), 12) == Goal(spp=12)
    assert settled(Goal(), 0) == Goal(spp=64)
    assert settled(Goal(seconds=3), 12) == Goal(seconds=3)


def test_only_time_needs_a_barrier_after_each_pass() -> None:
    assert not has_barriers(Goal(spp=8), NO_LIMITS)
    assert not has_barriers(Goal(rel_error=0.1), NO_LIMITS)
    assert has_barriers(Goal(seconds=3), NO_LIMITS)
    assert has_barriers(Goal(spp=8), Limits(seconds=1))
    assert has_barriers(Goal(rel_error=0.1), Limits(seconds=1))
