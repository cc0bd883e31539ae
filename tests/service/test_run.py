"""What a job's memory decides: when passes are merged and when a film is written."""

from dataclasses import replace
from pathlib import Path
from typing import Any

from test_ledger import FACTS, GRID, REQUEST, REVISION

from fluxfarm.domain.goal import Goal, Limits
from fluxfarm.domain.job import JobState
from fluxfarm.domain.leases import Decision, SceneRef
from fluxfarm.domain.records import JobRecord, OpenedPass, StoredTile, Unmerged
from fluxfarm.domain.scene import SceneBundle
from fluxfarm.domain.schedule import Round, SampleRange
from fluxfarm.orchestrator.run import MERGE_PAUSE, PASSES_TO_A_FILM, JobRun

LATER = 1e18
SCENE = SceneRef("key", Path(), "scene.xml", 0, 0, "", SceneBundle("scene.xml", {"scene.xml": "0" * 64}))


def running(
    goal: Goal, unmerged: Unmerged | None = None, merged_passes: int = 0, limits: Limits | None = None
) -> JobRun:
    """A run of a frame of few tiles, at time 0."""
    newest = replace(REVISION, passes=merged_passes) if merged_passes else None
    request = replace(REQUEST, goal=goal, limits=limits or Limits())
    record = JobRecord(
        "job", JobState.RUNNING, None, request, 0.0, FACTS, GRID, (), 0, 0, 0, 0, merged_passes, 0.0, 0, 0, newest
    )
    run = JobRun(record, SCENE)
    run.start(FACTS, GRID, unmerged, 0.0)
    return run


def finish_pass(run: JobRun, fence: int) -> OpenedPass:
    """Open the next pass and commit all of its tiles."""
    opened = run.open_pass(0.0)
    assert opened is not None
    while (lease := run.take_lease(fence, 1, 1, 1.0, Path(str(fence)))) is not None:
        for tile in lease.tiles:
            run.commit(fence, lease.pass_index, tile, f"{lease.pass_index}-{tile}")
        run.end_lease(fence)
        fence += 1
    return opened


def merge(run: JobRun, began: float, ended: float, film: str | None = None, **decided: Any) -> None:
    passes = run.mergeable(began)[-1].index + 1
    run.end_merge(ended - began, ended)
    run.publish(replace(REVISION, passes=passes, film=film, **decided))


def ready(run: JobRun, now: float) -> list[int]:
    """Indices of the passes that would be merged now."""
    return [work.index for work in run.mergeable(now)]


def test_lease_that_ends_early_gives_its_undone_tiles_back_and_names_their_files() -> None:
    run = running(Goal(spp=4))
    assert run.open_pass(0.0) is not None
    lease = run.take_lease(7, 1, 1, 1.0, Path("scratch/7"))
    assert lease is not None
    run.commit(7, lease.pass_index, lease.tiles[0], "0" * 64)
    assert run.end_lease(7) == [Path(f"scratch/7-{position}.tile") for position in range(1, len(lease.tiles))]
    again = run.take_lease(8, 1, 1, 1.0, Path("scratch/8"))
    assert again is not None
    assert again.tiles == lease.tiles[1:]


def test_next_merge_waits_in_proportion_to_the_last() -> None:
    run = running(Goal(spp=1000))
    finish_pass(run, 1)
    merge(run, began=1.0, ended=1.5)
    finish_pass(run, 100)
    assert ready(run, 1.5 + 0.99 * MERGE_PAUSE * 0.5) == []
    finish_pass(run, 200)
    assert ready(run, 1.5 + 1.01 * MERGE_PAUSE * 0.5) == [1, 2]


def test_last_merge_does_not_wait() -> None:
    run = running(Goal(spp=2))
    finish_pass(run, 1)
    merge(run, began=1.0, ended=2.0)
    finish_pass(run, 100)
    assert ready(run, 2.0) == []
    assert run.open_pass(2.0) is None, "all samples are taken"
    assert ready(run, 2.0) == [1]
    assert run.wants_film(run.mergeable(2.0))


def take_first_round(run: JobRun) -> None:
    """Render the sixteen samples with which an error goal begins, merging the first pass at once."""
    finish_pass(run, 1)
    merge(run, began=1.0, ended=2.0)
    for number in range(1, 5):
        assert ready(run, 2.0) == [], "a revision in the middle of a round can wait"
        finish_pass(run, 100 * number)


def test_merge_that_decides_an_error_goal_does_not_wait_and_nothing_is_rendered_before_it() -> None:
    run = running(Goal(rel_error=0.01))
    take_first_round(run)
    assert run.open_pass(2.0) is None
    assert ready(run, 2.0) == [1, 2, 3, 4]
    assert run.decision(run.mergeable(2.0)) == Decision(0.01, 1, 65_536, SCENE)


def test_round_of_some_tiles_renders_those_alone_until_it_is_decided_again() -> None:
    run = running(Goal(rel_error=0.01))
    take_first_round(run)
    merge(run, 2.0, 3.0, error_bound=0.5, next_round=Round(2, SampleRange(16, 32), (1, 3)), samples_expected=5e5)
    assert run.samples_expected == 5e5
    assert run.stop is None
    opened = finish_pass(run, 1000)
    assert (opened.samples, opened.tiles) == (SampleRange(16, 32), (1, 3))
    assert run.mergeable(LATER)[0].done.keys() == {1, 3}
    assert run.decision(run.mergeable(LATER)) == Decision(0.01, 2, 65_536, SCENE)
    merge(run, 4.0, 5.0, error_bound=0.009)
    assert run.open_pass(5.0) is None
    assert run.stop is not None
    assert run.stop.warning is None


def test_error_goal_that_may_take_no_more_samples_says_so() -> None:
    run = running(Goal(rel_error=0.01), limits=Limits(spp=1))
    finish_pass(run, 1)
    merge(run, 1.0, 2.0, error_bound=0.5)
    assert run.open_pass(2.0) is None
    assert run.stop is not None
    assert run.stop.warning is not None
    assert "expected at most 0.01" in run.stop.warning


def test_film_takes_the_place_of_loose_tiles_in_the_order_of_their_passes() -> None:
    run = running(Goal(spp=1000))
    for number in range(PASSES_TO_A_FILM - 1):
        finish_pass(run, 100 * number + 1)
        assert not run.wants_film(run.mergeable(LATER))
        merge(run, began=1e9 * number, ended=1e9 * number)
    assert run.loose_tiles[: len(GRID.order())] == tuple(f"0-{tile}" for tile in sorted(GRID.order()))
    assert len(run.loose_tiles) == (PASSES_TO_A_FILM - 1) * len(GRID.order())
    finish_pass(run, 10_000)
    assert run.wants_film(run.mergeable(LATER))
    merge(run, began=1e12, ended=1e12, film="f" * 64)
    assert (run.film, run.loose_tiles) == ("f" * 64, ())


def test_restart_goes_on_from_the_film_and_the_loose_tiles() -> None:
    tiles = tuple(StoredTile(index, tile, f"{index}-{tile}") for index in (1, 2) for tile in sorted(GRID.order()))
    unmerged = Unmerged(None, 4, (OpenedPass(2, SampleRange(2, 4), None),), "f" * 64, tiles)
    run = running(Goal(spp=1000), unmerged, merged_passes=2)
    assert run.film == "f" * 64
    assert run.loose_tiles == tuple(tile.sha256 for tile in tiles if tile.pass_index == 1)
    assert ready(run, 0.0) == [2]
    opened = run.open_pass(0.0)
    assert opened is not None
    assert opened.samples == SampleRange(4, 8)


def test_restart_in_a_round_goes_on_with_its_tiles() -> None:
    decision = replace(REVISION, passes=5, error_bound=0.5, next_round=Round(2, SampleRange(16, 32), (1, 3)))
    tiles = (StoredTile(5, 3, "5-3"),)
    begun = Unmerged(decision, 32, (OpenedPass(5, SampleRange(16, 32), (1, 3)),), "f" * 64, tiles)
    run = running(Goal(rel_error=0.01), begun, merged_passes=5)
    assert run.open_pass(0.0) is None, "tile 1 is missing"
    lease = run.take_lease(1, 1, 1, 1.0, Path("1"))
    assert lease is not None
    assert lease.tiles == (1,)

    not_begun = running(Goal(rel_error=0.01), Unmerged(decision, None, (), "f" * 64, ()), merged_passes=5)
    opened = not_begun.open_pass(0.0)
    assert opened is not None
    assert (opened.samples, opened.tiles) == (SampleRange(16, 32), (1, 3))
