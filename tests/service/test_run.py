"""What a job's memory decides: when passes are merged and when a film is written."""

from dataclasses import replace
from pathlib import Path

from test_ledger import FACTS, GRID, REQUEST, REVISION

from fluxfarm.domain.goal import Goal
from fluxfarm.domain.job import JobState
from fluxfarm.domain.leases import SceneRef
from fluxfarm.domain.records import JobRecord, StoredTile, Unmerged
from fluxfarm.domain.schedule import SampleRange
from fluxfarm.orchestrator.run import MERGE_PAUSE, PASSES_TO_A_FILM, JobRun, PassRun


def running(goal: Goal, unmerged: Unmerged | None = None, merged_passes: int = 0) -> JobRun:
    """A run of a frame of few tiles, at time 0."""
    newest = replace(REVISION, passes=merged_passes) if merged_passes else None
    request = replace(REQUEST, goal=goal)
    record = JobRecord(
        "job", JobState.RUNNING, None, request, 0.0, FACTS, GRID, (), 0, 0, 0, 0, merged_passes, 0.0, 0, 0, newest
    )
    run = JobRun(record, SceneRef("key", Path(), "scene.xml", 0, 0, ""))
    run.start(FACTS, GRID, unmerged, 0.0)
    return run


def finish_pass(run: JobRun, fence: int) -> PassRun:
    """Open the next pass and commit all of its tiles."""
    opened = run.open_pass(0.0)
    assert opened is not None
    while (lease := run.take_lease(fence, 1, 1, 1.0)) is not None:
        for tile in lease.tiles:
            run.commit(fence, lease.pass_index, tile, f"{lease.pass_index}-{tile}")
        run.end_lease(fence)
        fence += 1
    return opened


def merge(run: JobRun, began: float, ended: float, film: str | None = None) -> None:
    passes = run.mergeable(began)[-1].index + 1
    run.end_merge(ended - began, ended)
    run.publish(replace(REVISION, passes=passes, film=film))


def test_next_merge_waits_in_proportion_to_the_last() -> None:
    run = running(Goal(spp=1000))
    finish_pass(run, 1)
    merge(run, began=1.0, ended=1.5)
    second = finish_pass(run, 100)
    assert run.mergeable(1.5 + 0.99 * MERGE_PAUSE * 0.5) == []
    third = finish_pass(run, 200)
    assert run.mergeable(1.5 + 1.01 * MERGE_PAUSE * 0.5) == [second, third]


def test_last_merge_and_that_of_a_goal_decided_by_error_do_not_wait() -> None:
    short = running(Goal(spp=2))
    finish_pass(short, 1)
    merge(short, began=1.0, ended=2.0)
    last = finish_pass(short, 100)
    assert short.mergeable(2.0) == []
    assert short.open_pass(2.0) is None, "all samples are taken"
    assert short.mergeable(2.0) == [last]
    assert short.wants_film([last])

    by_error = running(Goal(rel_error=0.01))
    finish_pass(by_error, 1)
    merge(by_error, began=1.0, ended=2.0)
    second = finish_pass(by_error, 100)
    assert by_error.mergeable(2.0) == [second]


def test_film_takes_the_place_of_loose_tiles_in_the_order_of_their_passes() -> None:
    run = running(Goal(spp=1000))
    for number in range(PASSES_TO_A_FILM - 1):
        ready = [finish_pass(run, 100 * number + 1)]
        assert not run.wants_film(ready)
        merge(run, began=1e9 * number, ended=1e9 * number)
    assert run.loose_tiles[: len(GRID.order())] == tuple(f"0-{tile}" for tile in sorted(GRID.order()))
    assert len(run.loose_tiles) == (PASSES_TO_A_FILM - 1) * len(GRID.order())
    assert run.wants_film([finish_pass(run, 10_000)])
    merge(run, began=1e12, ended=1e12, film="f" * 64)
    assert (run.film, run.loose_tiles) == ("f" * 64, ())


def test_restart_goes_on_from_the_film_and_the_loose_tiles() -> None:
    tiles = tuple(StoredTile(index, tile, f"{index}-{tile}") for index in (1, 2) for tile in sorted(GRID.order()))
    unmerged = Unmerged(2, ((2, SampleRange(2, 4)),), "f" * 64, tiles)
    run = running(Goal(spp=1000), unmerged, merged_passes=2)
    assert run.film == "f" * 64
    assert run.loose_tiles == tuple(tile.sha256 for tile in tiles if tile.pass_index == 1)
    assert [work.index for work in run.mergeable(0.0)] == [2]
