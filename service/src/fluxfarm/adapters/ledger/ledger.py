"""The Ledger role on a Database: writes are `changes`, reads are here."""

from collections.abc import Callable, Sequence
from concurrent.futures import Future
from pathlib import Path
from typing import Any, TypeVar

from sqlalchemy import Connection, func, select, text

from fluxfarm.adapters.ledger import changes, key_changes, rows
from fluxfarm.adapters.ledger.database import Database
from fluxfarm.adapters.ledger.schema import api_keys, events, jobs, passes, revisions, tiles
from fluxfarm.domain.access import ApiKey, Usage
from fluxfarm.domain.events import Event
from fluxfarm.domain.job import JobState
from fluxfarm.domain.records import (
    JobRecord,
    JobRequest,
    OpenedPass,
    Revision,
    SceneFacts,
    StoredTile,
    TileCommit,
    Unmerged,
)
from fluxfarm.domain.tiles import TileGrid

T = TypeVar("T")


class SqliteLedger:
    """The ledger in the file `path`. Calls may come from one event loop."""

    def __init__(self, path: Path, journal: str = "wal", durable: bool = True) -> None:
        """Open, check and migrate; raises StoreDamaged or SchemaTooNew. Revokes every lease of an earlier service."""
        self._database = Database(path, journal, durable)
        self._database.post(changes.revoke_all).result()

    def close(self) -> None:
        """Finish waiting writes and close."""
        self._database.close()

    async def add_job(
        self, job_id: str, request: JobRequest, key: str | None, body_sha256: str, owner: ApiKey | None = None
    ) -> str:
        return await self._write(changes.add_job, job_id, request, key, body_sha256, owner)

    async def change_state(
        self, job_id: str, state: JobState, reason: str | None = None, running_s: float | None = None
    ) -> None:
        await self._write(changes.change_state, job_id, state, reason, running_s)

    async def record_facts(self, fence: int, job_id: str, facts: SceneFacts, grid: TileGrid) -> None:
        await self._write(changes.record_facts, fence, job_id, facts, grid)

    def grant(self, fence: int, job_id: str) -> None:
        self._post(changes.grant, fence, job_id)

    def open_pass(self, job_id: str, opened: OpenedPass) -> None:
        self._post(changes.open_pass, job_id, opened)

    async def commit_tiles(self, commits: Sequence[TileCommit], ended: Sequence[int]) -> list[bool]:
        return await self._write(changes.commit_tiles, commits, ended)

    async def record_revision(self, fence: int, job_id: str, revision: Revision) -> list[str]:
        return await self._write(changes.record_revision, fence, job_id, revision)

    async def count_failure(self, job_id: str, crash: bool, running_s: float) -> int:
        return await self._write(changes.count_failure, job_id, crash, running_s)

    async def warn(self, job_id: str, message: str) -> None:
        await self._write(changes.warn, job_id, message)

    async def delete_job(self, job_id: str) -> None:
        await self._write(changes.delete_job, job_id)

    async def job(self, job_id: str) -> JobRecord:
        def read(connection: Connection) -> JobRecord:
            found = _records(connection, select(jobs).where(jobs.c.id == job_id))
            if not found:
                raise changes.absent(connection, job_id)
            return found[0]

        return await self._database.read(read)

    async def jobs(self, states: Sequence[JobState] = (), limit: int | None = None) -> list[JobRecord]:
        query = select(jobs).order_by(jobs.c.created_at.desc()).limit(limit)
        if states:
            query = query.where(jobs.c.state.in_(states))
        return await self._database.read(lambda connection: _records(connection, query))

    async def counts(self) -> dict[str, int]:
        """Number of jobs by state."""
        query = select(jobs.c.state, func.count()).group_by(jobs.c.state)
        return await self._database.read(lambda connection: {row[0]: row[1] for row in connection.execute(query)})

    async def unmerged(self, job_id: str) -> Unmerged:
        def read(connection: Connection) -> Unmerged:
            newest = select(func.coalesce(func.max(revisions.c.passes), 0)).where(revisions.c.job_id == job_id)
            first = connection.execute(newest).scalar_one()
            decided = connection.execute(
                select(revisions)
                .where(revisions.c.job_id == job_id, revisions.c.error_bound.is_not(None))
                .order_by(revisions.c.number.desc())
                .limit(1)
            ).first()
            decision = None if decided is None else rows.revision_from_row(decided)
            since = 0 if decision is None else decision.passes
            opened = connection.execute(
                select(passes)
                .where(passes.c.job_id == job_id, passes.c.pass_index >= min(first, since))
                .order_by(passes.c.pass_index)
            ).all()
            film = select(revisions.c.film).where(revisions.c.job_id == job_id, revisions.c.film.is_not(None))
            stored = connection.execute(
                select(tiles).where(tiles.c.job_id == job_id).order_by(tiles.c.pass_index, tiles.c.tile)
            )
            return Unmerged(
                decision,
                max((row.sample_end for row in opened if row.pass_index >= since), default=None),
                tuple(rows.pass_from_row(row) for row in opened if row.pass_index >= first),
                connection.execute(film).scalar(),
                tuple(StoredTile(row.pass_index, row.tile, row.sha256) for row in stored),
            )

        return await self._database.read(read)

    async def events_after(self, job_id: str, seq: int, limit: int) -> list[Event]:
        query = select(events).where(events.c.job_id == job_id, events.c.seq > seq).order_by(events.c.seq).limit(limit)
        return await self._database.read(
            lambda connection: [rows.event_from_row(row) for row in connection.execute(query)]
        )

    async def revisions(self, job_id: str) -> list[Revision]:
        query = select(revisions).where(revisions.c.job_id == job_id).order_by(revisions.c.number)
        return await self._database.read(
            lambda connection: [rows.revision_from_row(row) for row in connection.execute(query)]
        )

    async def add_key(self, key: ApiKey, sha256: str) -> None:
        await self._write(key_changes.add_key, key, sha256)

    async def drop_key(self, key_id: str) -> bool:
        return await self._write(key_changes.drop_key, key_id)

    async def keys(self) -> dict[str, ApiKey]:
        query = select(api_keys).order_by(api_keys.c.created_at)
        return await self._database.read(
            lambda connection: {row.sha256: rows.key_from_row(row) for row in connection.execute(query)}
        )

    async def usage(self, key_id: str) -> tuple[int, list[Usage]]:
        def read(connection: Connection) -> tuple[int, list[Usage]]:
            return key_changes.unfinished_jobs(connection, key_id), key_changes.usage(connection, key_id)

        return await self._database.read(read)

    async def bytes_left(self, key: ApiKey) -> int | None:
        return await self._database.read(lambda connection: key_changes.bytes_left(connection, key))

    async def note_upload(self, key_id: str, sent_bytes: int) -> None:
        await self._write(key_changes.note_usage, key_id, sent_bytes, 0)

    async def highest_fence(self) -> int:
        query = text("SELECT seq FROM sqlite_sequence WHERE name = 'leases'")
        return await self._database.read(lambda connection: int(connection.execute(query).scalar() or 0))

    async def files(self) -> dict[str, set[str]]:
        """For the sweep at start-up: job id -> digests of the files that the ledger names."""

        def read(connection: Connection) -> dict[str, set[str]]:
            named: dict[str, set[str]] = {job_id: set() for job_id in connection.execute(select(jobs.c.id)).scalars()}
            for row in connection.execute(select(tiles.c.job_id, tiles.c.sha256)):
                named[row.job_id].add(row.sha256)
            for row in connection.execute(select(revisions)):
                named[row.job_id].update(sha256 for sha256 in (row.exr, row.png, row.film) if sha256)
            return named

        return await self._database.read(read)

    async def _write(self, change: Callable[..., T], *arguments: object) -> T:
        return await self._database.write(lambda connection: change(connection, *arguments))

    def _post(self, change: Callable[..., Any], *arguments: object) -> "Future[Any]":
        return self._database.post(lambda connection: change(connection, *arguments))


def _records(connection: Connection, query: Any) -> list[JobRecord]:
    """The jobs of `query`, each with its newest revision."""
    found = connection.execute(query).all()
    newest_number = (
        select(revisions.c.job_id, func.max(revisions.c.number).label("number"))
        .where(revisions.c.job_id.in_([row.id for row in found]))
        .group_by(revisions.c.job_id)
        .subquery()
    )
    newest = connection.execute(
        select(revisions).join(
            newest_number,
            (revisions.c.job_id == newest_number.c.job_id) & (revisions.c.number == newest_number.c.number),
        )
    )
    by_job = {row.job_id: rows.revision_from_row(row) for row in newest}
    return [rows.job_from_row(row, by_job.get(row.id)) for row in found]
