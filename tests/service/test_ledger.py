"""The ledger alone: transitions, fences, events, durability."""

import asyncio
import sqlite3
import uuid
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pytest
from hypothesis import HealthCheck
from hypothesis import settings as hypothesis_settings
from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, invariant, rule
from sqlalchemy import create_engine, inspect

from fluxfarm.adapters.ledger import SqliteLedger, rows, schema
from fluxfarm.adapters.ledger.database import migrate
from fluxfarm.domain.events import EventKind
from fluxfarm.domain.goal import Goal, Limits
from fluxfarm.domain.job import STATE_SENTENCES, TERMINAL_STATES, TRANSITIONS, JobState
from fluxfarm.domain.records import JobRequest, Revision, SceneFacts, TileCommit
from fluxfarm.domain.scene import SceneBundle
from fluxfarm.domain.schedule import Round, SampleRange
from fluxfarm.domain.tiles import PixelRect, TileGrid
from fluxfarm.errors import (
    Gone,
    IdempotencyConflict,
    IllegalTransition,
    JobNotFound,
    SchemaTooNew,
    StaleLease,
    StoreDamaged,
    StoreUnusable,
)

REQUEST = JobRequest(
    name="a",
    bundle=SceneBundle("scene.xml", {"scene.xml": "0" * 64}),
    builtin=None,
    size=None,
    crop=None,
    integrator=None,
    goal=Goal(spp=4),
    limits=Limits(),
    priority=0,
    seed=7,
)
FACTS = SceneFacts(32, 32, PixelRect(0, 0, 32, 32), 0, "path", ("one warning",), {"parts": {}}, 0.1)
GRID = TileGrid(FACTS.crop, 16)
REVISION = Revision(1, 1, 1, 1, 1.0, None, 0.0, (0.0, 0.0, 0.0), 0, 1.5, "e" * 64, 10, "p" * 64, "f" * 64, 0.0)


@pytest.fixture
def ledger(tmp_path: Path) -> Iterator[SqliteLedger]:
    opened = SqliteLedger(tmp_path / "ledger.sqlite3")
    yield opened
    opened.close()


async def running_job(ledger: SqliteLedger) -> str:
    job_id = await ledger.add_job(str(uuid.uuid4()), REQUEST, None, "")
    await ledger.change_state(job_id, JobState.PREPARING)
    ledger.grant(1, job_id)
    await ledger.record_facts(1, job_id, FACTS, GRID)
    return job_id


def commit(job_id: str, fence: int, tile: int) -> TileCommit:
    return TileCommit(fence, job_id, 0, tile, tile, 0, GRID.rect(tile), 256, f"{tile:064}", 0.1, 10, 0)


def test_job_is_read_back_as_it_was_written(ledger: SqliteLedger) -> None:
    async def scenario() -> None:
        request = replace(REQUEST, size=(8, 9), crop=PixelRect(1, 2, 3, 4), goal=Goal(rel_error=0.5))
        job_id = await ledger.add_job("a-job", request, None, "")
        assert (await ledger.job(job_id)).request == request

    asyncio.run(scenario())


def test_tile_of_a_live_lease_is_taken_and_of_a_revoked_one_refused(ledger: SqliteLedger) -> None:
    async def scenario() -> None:
        job_id = await running_job(ledger)
        ledger.grant(2, job_id)
        assert await ledger.commit_tiles([commit(job_id, 2, 0), commit(job_id, 3, 1)], []) == [True, False]
        await ledger.change_state(job_id, JobState.CANCELLED)
        assert await ledger.commit_tiles([commit(job_id, 2, 1)], []) == [False]
        job = await ledger.job(job_id)
        assert (job.tiles_done, job.samples_done, job.rays) == (1, 256, 10)
        with pytest.raises(StaleLease):
            await ledger.record_revision(2, job_id, REVISION)

    asyncio.run(scenario())


def test_lease_granted_after_the_cancel_commits_nothing(ledger: SqliteLedger) -> None:
    async def scenario() -> None:
        job_id = await running_job(ledger)
        await ledger.change_state(job_id, JobState.CANCELLED)
        ledger.grant(2, job_id)
        assert await ledger.commit_tiles([commit(job_id, 2, 0)], []) == [False]

    asyncio.run(scenario())


def test_ended_lease_is_alive_for_the_tiles_of_its_own_batch_only(ledger: SqliteLedger) -> None:
    async def scenario() -> None:
        job_id = await running_job(ledger)
        ledger.grant(2, job_id)
        assert await ledger.commit_tiles([commit(job_id, 2, 0)], [2]) == [True]
        assert await ledger.commit_tiles([commit(job_id, 2, 1)], []) == [False]

    asyncio.run(scenario())


def test_revision_takes_its_tiles_and_the_film_before_out_of_the_ledger(ledger: SqliteLedger) -> None:
    async def scenario() -> None:
        job_id = await running_job(ledger)
        for fence in (2, 3, 4):
            ledger.grant(fence, job_id)
        await ledger.commit_tiles([commit(job_id, 2, tile) for tile in range(4)], [])
        assert len(await ledger.record_revision(3, job_id, REVISION)) == 4
        await ledger.record_revision(4, job_id, replace(REVISION, number=2, passes=2, film="g" * 64))
        assert [revision.film for revision in await ledger.revisions(job_id)] == [None, "g" * 64]
        assert (await ledger.unmerged(job_id)).tiles == ()
        assert (await ledger.job(job_id)).newest == (await ledger.revisions(job_id))[-1]

    asyncio.run(scenario())


def test_revision_without_a_film_keeps_the_film_before_and_its_own_tiles(ledger: SqliteLedger) -> None:
    async def scenario() -> None:
        job_id = await running_job(ledger)
        for fence in (2, 3, 4, 5):
            ledger.grant(fence, job_id)
        await ledger.record_revision(3, job_id, REVISION)
        later = [replace(commit(job_id, 2, tile), pass_index=1) for tile in (1, 0)]
        await ledger.commit_tiles(later, [])
        assert await ledger.record_revision(4, job_id, replace(REVISION, number=2, passes=2, film=None)) == []
        unmerged = await ledger.unmerged(job_id)
        assert unmerged.film == REVISION.film
        assert [(tile.pass_index, tile.tile) for tile in unmerged.tiles] == [(1, 0), (1, 1)]
        assert len(await ledger.record_revision(5, job_id, replace(REVISION, number=3, passes=3, film="g" * 64))) == 2
        assert (await ledger.unmerged(job_id)).film == "g" * 64

    asyncio.run(scenario())


def test_decision_of_an_error_goal_is_read_back_as_it_was_written(ledger: SqliteLedger) -> None:
    async def scenario() -> None:
        job_id = await running_job(ledger)
        decided = {"error_bound": 0.5, "samples_expected": 1e6, "next_round": Round(2, SampleRange(16, 32), (0, 3))}
        first = replace(REVISION, film=None, **decided)
        missing = replace(
            first, number=2, passes=2, next_round=None, error_unseen=0.25, unseen_warning="light is missing"
        )
        for fence, revision in ((2, first), (3, missing)):
            ledger.grant(fence, job_id)
            await ledger.record_revision(fence, job_id, revision)
        assert await ledger.revisions(job_id) == [first, missing]

    asyncio.run(scenario())


def test_failed_write_undoes_itself_alone(ledger: SqliteLedger) -> None:
    async def scenario() -> None:
        job_id = await running_job(ledger)
        ledger.grant(2, job_id)
        wrong = ledger.change_state(job_id, JobState.QUEUED)
        right = ledger.commit_tiles([commit(job_id, 2, 0)], [])
        outcomes = await asyncio.gather(wrong, right, return_exceptions=True)
        assert isinstance(outcomes[0], IllegalTransition)
        assert outcomes[1] == [True]

    asyncio.run(scenario())


def test_events_count_from_one_without_gaps(ledger: SqliteLedger) -> None:
    async def scenario() -> None:
        job_id = await running_job(ledger)
        ledger.grant(2, job_id)
        await asyncio.gather(*(ledger.commit_tiles([commit(job_id, 2, tile)], []) for tile in range(4)))
        await ledger.change_state(job_id, JobState.CANCELLED)
        events = await ledger.events_after(job_id, 0, 100)
        assert [event.seq for event in events] == list(range(1, len(events) + 1))
        assert events[-1].kind is EventKind.END
        assert await ledger.events_after(job_id, events[-2].seq, 100) == [events[-1]]

    asyncio.run(scenario())


def test_idempotency_key_gives_the_same_job_or_a_conflict(ledger: SqliteLedger) -> None:
    async def scenario() -> None:
        assert await ledger.add_job("one", REQUEST, "key", "body") == "one"
        assert await ledger.add_job("two", REQUEST, "key", "body") == "one"
        with pytest.raises(IdempotencyConflict):
            await ledger.add_job("three", REQUEST, "key", "other body")
        assert [job.id for job in await ledger.jobs()] == ["one"]

    asyncio.run(scenario())


def test_deleted_job_is_gone_and_an_unknown_one_not_found(ledger: SqliteLedger) -> None:
    async def scenario() -> None:
        job_id = await running_job(ledger)
        with pytest.raises(IllegalTransition):
            await ledger.delete_job(job_id)
        await ledger.change_state(job_id, JobState.FAILED, "why")
        await ledger.delete_job(job_id)
        with pytest.raises(Gone):
            await ledger.job(job_id)
        with pytest.raises(JobNotFound):
            await ledger.job("never")

    asyncio.run(scenario())


def test_fences_rise_over_restarts(tmp_path: Path) -> None:
    async def scenario() -> None:
        first = SqliteLedger(tmp_path / "ledger.sqlite3")
        job_id = await running_job(first)
        first.grant(9, job_id)
        await first.commit_tiles([], [9])
        first.close()
        second = SqliteLedger(tmp_path / "ledger.sqlite3")
        assert await second.highest_fence() == 9
        second.close()

    asyncio.run(scenario())


def test_damaged_or_newer_database_is_refused(tmp_path: Path) -> None:
    damaged = tmp_path / "damaged.sqlite3"
    damaged.write_bytes(b"not a database" * 1000)
    with pytest.raises(StoreDamaged):
        SqliteLedger(damaged)
    newer = tmp_path / "newer.sqlite3"
    with sqlite3.connect(newer) as connection:
        connection.execute("CREATE TABLE schema_version (version INTEGER NOT NULL) STRICT")
        connection.execute("INSERT INTO schema_version VALUES (999)")
    connection.close()
    with pytest.raises(SchemaTooNew):
        SqliteLedger(newer)


def test_database_that_another_program_holds_or_that_cannot_be_written_says_so(tmp_path: Path) -> None:
    held = tmp_path / "held.sqlite3"
    SqliteLedger(held).close()
    other = sqlite3.connect(held, isolation_level=None)
    other.execute("PRAGMA locking_mode = EXCLUSIVE")
    other.execute("BEGIN EXCLUSIVE")
    with pytest.raises(StoreUnusable, match=r"held\.sqlite3: database is locked"):
        SqliteLedger(held)
    other.close()
    (tmp_path / "folder").mkdir()
    with pytest.raises(StoreUnusable, match=r"folder: unable to open"):
        SqliteLedger(tmp_path / "folder")


def test_database_of_the_first_version_is_brought_to_the_newest(tmp_path: Path) -> None:
    path = tmp_path / "first.sqlite3"
    request = rows.to_json(
        {
            "name": "old",
            "bundle": {"entry": "scene.xml", "files": {"scene.xml": "0" * 64}},
            "builtin": None,
            "size": None,
            "crop": None,
            "integrator": None,
            "goal": {"rel_error": None, "spp": 4, "seconds": None},
            "limits": {"spp": None, "seconds": None},
            "priority": 0,
            "seed": 7,
        }
    )
    connection = sqlite3.connect(path)
    connection.executescript(schema.MIGRATIONS[0])
    connection.execute("CREATE TABLE schema_version (version INTEGER NOT NULL) STRICT")
    connection.execute("INSERT INTO schema_version VALUES (1)")
    connection.execute(
        "INSERT INTO jobs (id, state, request, created_at, last_seq) VALUES ('old', 'SUCCEEDED', ?, 5, 1)", (request,)
    )
    connection.execute("INSERT INTO events VALUES ('old', 1, 'state', 5, '{\"state\": \"QUEUED\"}')")
    connection.execute(
        "INSERT INTO revisions VALUES ('old', 1, 1, 4, 4, 0.1, 0, 0, 0, 0, 1.5, 'exr', 10, 'png', 'film', 6)"
    )
    connection.commit()
    connection.close()

    async def scenario() -> None:
        ledger = SqliteLedger(path)
        job = await ledger.job("old")
        assert (job.request.goal, job.request.seed, job.owner) == (Goal(spp=4), 7, None)
        assert job.newest == Revision(1, 1, 4, 4, 4.0, 0.1, 0.0, (0, 0, 0), 0, 1.5, "exr", 10, "png", "film", 6)
        assert [event.kind for event in await ledger.events_after("old", 0, 10)] == [EventKind.STATE]
        new = await ledger.add_job("new", REQUEST, None, "b")
        assert {record.id for record in await ledger.jobs()} == {"old", new}
        ledger.close()

    asyncio.run(scenario())


def test_tables_are_described_as_the_migrations_make_them(tmp_path: Path) -> None:
    engine = create_engine(f"sqlite:///{tmp_path / 'schema.sqlite3'}")
    migrate(engine)
    inspector = inspect(engine)
    for table in schema.metadata.tables.values():
        columns = {column["name"] for column in inspector.get_columns(table.name)}
        assert columns == set(table.columns.keys()), table.name
        key = inspector.get_pk_constraint(table.name)["constrained_columns"]
        assert set(key) == {column.name for column in table.primary_key}, table.name
    engine.dispose()


def test_every_state_has_a_sentence_and_a_way_to_an_end() -> None:
    assert set(STATE_SENTENCES) == set(TRANSITIONS) == set(JobState)
    assert {JobState.SUCCEEDED, JobState.FAILED, JobState.CANCELLED} == TERMINAL_STATES
    for state in JobState:
        reached, waiting = {state}, [state]
        while waiting:
            following = TRANSITIONS[waiting.pop()] - reached
            reached |= following
            waiting.extend(following)
        assert reached & TERMINAL_STATES


class LedgerMachine(RuleBasedStateMachine):
    """Any sequence of commands leaves the ledger where the table of transitions says."""

    folder: Path

    def __init__(self) -> None:
        super().__init__()
        self.ledger = SqliteLedger(self.folder / f"{uuid.uuid4().hex}.sqlite3")
        self.loop = asyncio.new_event_loop()
        self.job_id = self.loop.run_until_complete(self.ledger.add_job("job", REQUEST, None, ""))
        self.expected, self.fence, self.live, self.taken = JobState.QUEUED, 0, False, 0

    @rule(state=st.sampled_from(JobState))
    def change(self, state: JobState) -> None:
        change = self.ledger.change_state(self.job_id, state)
        if state in TRANSITIONS[self.expected]:
            self.loop.run_until_complete(change)
            self.expected = state
            self.live = self.live and state in (JobState.PREPARING, JobState.RUNNING, JobState.FINALIZING)
        else:
            with pytest.raises(IllegalTransition):
                self.loop.run_until_complete(change)

    @rule()
    def grant(self) -> None:
        self.fence += 1
        self.ledger.grant(self.fence, self.job_id)
        self.live = self.expected in (JobState.PREPARING, JobState.RUNNING, JobState.FINALIZING)

    @rule()
    def commit(self) -> None:
        tile = commit(self.job_id, self.fence, 0)
        taken = self.loop.run_until_complete(self.ledger.commit_tiles([replace(tile, tile=self.taken)], []))
        assert taken == [self.live and self.fence > 0]
        self.taken += taken[0]

    @invariant()
    def ledger_agrees(self) -> None:
        job = self.loop.run_until_complete(self.ledger.job(self.job_id))
        assert (job.state, job.tiles_done) == (self.expected, self.taken)
        events = self.loop.run_until_complete(self.ledger.events_after(self.job_id, 0, 1000))
        assert [event.seq for event in events] == list(range(1, len(events) + 1))

    def teardown(self) -> None:
        self.ledger.close()
        self.loop.close()


def test_any_sequence_of_commands_follows_the_table(tmp_path: Path) -> None:
    machine = type("Machine", (LedgerMachine,), {"folder": tmp_path})
    case = machine.TestCase
    case.settings = hypothesis_settings(
        max_examples=10, stateful_step_count=12, deadline=None, suppress_health_check=list(HealthCheck)
    )
    case().runTest()
