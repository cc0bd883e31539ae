"""Every change of the ledger, each a function that works inside one transaction of the writer.

Here is the guard of promise 5: what a lease brings is taken only while its row stands, and cancelling removes the row
in the same transaction that changes the state.
"""

import json
import time
from collections import Counter
from collections.abc import Sequence
from typing import Any

from sqlalchemy import Connection, delete, insert, select, update

from fluxfarm.adapters.ledger import rows
from fluxfarm.adapters.ledger.key_changes import check_job, note_usage
from fluxfarm.adapters.ledger.schema import (
    deleted_jobs,
    events,
    idempotency_keys,
    jobs,
    leases,
    passes,
    revisions,
    tiles,
)
from fluxfarm.domain.access import ApiKey
from fluxfarm.domain.events import EventKind
from fluxfarm.domain.job import TERMINAL_STATES, JobState, check_transition
from fluxfarm.domain.records import JobRequest, OpenedPass, Revision, SceneFacts, TileCommit
from fluxfarm.domain.tiles import TileGrid
from fluxfarm.errors import Gone, IdempotencyConflict, IllegalTransition, JobNotFound, StaleLease

WORKING_STATES = frozenset({JobState.PREPARING, JobState.RUNNING, JobState.FINALIZING})


def append_events(connection: Connection, job_id: str, told: Sequence[tuple[EventKind, dict[str, Any]]]) -> None:
    """Add events after the job's last one."""
    last = connection.execute(
        update(jobs).where(jobs.c.id == job_id).values(last_seq=jobs.c.last_seq + len(told)).returning(jobs.c.last_seq)
    ).scalar_one()
    now = time.time()
    first = last - len(told) + 1
    connection.execute(
        insert(events),
        [
            {"job_id": job_id, "seq": seq, "kind": kind, "at": now, "data": json.dumps(data, separators=(",", ":"))}
            for seq, (kind, data) in enumerate(told, first)
        ],
    )


def find_state(connection: Connection, job_id: str) -> JobState:
    """The job's state; raises JobNotFound or Gone."""
    state: str | None = connection.execute(select(jobs.c.state).where(jobs.c.id == job_id)).scalar()
    if state is None:
        raise absent(connection, job_id)
    return JobState(state)


def absent(connection: Connection, job_id: str) -> Gone | JobNotFound:
    """The error that says that the job was deleted, or never was."""
    if connection.execute(select(deleted_jobs.c.id).where(deleted_jobs.c.id == job_id)).first() is not None:
        return Gone(f"job {job_id}: was deleted")
    return JobNotFound(f"job {job_id}: not found; expected the id of a job that this service accepted")


def add_job(
    connection: Connection,
    job_id: str,
    request: JobRequest,
    key: str | None,
    body_sha256: str,
    owner: ApiKey | None,
) -> str:
    """Record a new job of `owner` unless `key` made one before; returns the id of the job. Raises QuotaExceeded."""
    now = time.time()
    if key is not None and owner is not None:
        key = f"{owner.id}:{key}"
    if key is not None:
        before = connection.execute(select(idempotency_keys).where(idempotency_keys.c.key == key)).first()
        if before is not None:
            if before.body_sha256 != body_sha256:
                raise IdempotencyConflict(
                    f"Idempotency-Key = {key!r}: was used for job {before.job_id} with another body; use a new key"
                )
            return str(before.job_id)
    if owner is not None:
        check_job(connection, owner, request.samples)
    if key is not None:
        connection.execute(
            insert(idempotency_keys).values(key=key, body_sha256=body_sha256, job_id=job_id, created_at=now)
        )
    connection.execute(
        insert(jobs).values(
            id=job_id,
            state=JobState.QUEUED,
            request=rows.request_to_json(request),
            created_at=now,
            last_seq=0,
            owner=None if owner is None else owner.id,
        )
    )
    append_events(connection, job_id, [(EventKind.STATE, {"state": JobState.QUEUED})])
    return job_id


def change_state(
    connection: Connection, job_id: str, state: JobState, reason: str | None, running_s: float | None
) -> None:
    """Check the transition, do it, revoke leases if work ends, and tell the watchers."""
    check_transition(job_id, find_state(connection, job_id), state)
    values: dict[str, Any] = {"state": state, "reason": reason}
    if running_s is not None:
        values["running_s"] = running_s
    connection.execute(update(jobs).where(jobs.c.id == job_id).values(values))
    if state not in WORKING_STATES:
        connection.execute(delete(leases).where(leases.c.job_id == job_id))
    data: dict[str, Any] = {"state": state}
    if reason is not None:
        data["reason"] = reason
    told = [(EventKind.STATE, data)]
    if state in TERMINAL_STATES:
        told.append((EventKind.END, data))
    append_events(connection, job_id, told)


def require_lease(connection: Connection, fence: int, job_id: str) -> None:
    """Raise StaleLease unless the lease stands; end it if it does."""
    ended = connection.execute(delete(leases).where(leases.c.fence == fence, leases.c.job_id == job_id))
    if ended.rowcount != 1:
        raise StaleLease(f"job {job_id}: lease {fence} was revoked; what it brings is dropped")


def record_facts(connection: Connection, fence: int, job_id: str, facts: SceneFacts, grid: TileGrid) -> None:
    """Keep what the engine found and set the job RUNNING."""
    require_lease(connection, fence, job_id)
    connection.execute(
        update(jobs)
        .where(jobs.c.id == job_id)
        .values(facts=rows.facts_to_json(facts), tile_size=grid.tile_size, warnings=json.dumps(facts.warnings))
    )
    if facts.warnings:
        append_events(connection, job_id, [(EventKind.WARNING, {"message": text}) for text in facts.warnings])
    change_state(connection, job_id, JobState.RUNNING, None, None)


def grant(connection: Connection, fence: int, job_id: str) -> None:
    """Let a lease stand, if the job is still being worked on."""
    if find_state(connection, job_id) in WORKING_STATES:
        connection.execute(insert(leases).values(fence=fence, job_id=job_id))


def open_pass(connection: Connection, job_id: str, opened: OpenedPass) -> None:
    """Record a pass; a pass that is there already stays as it is."""
    connection.execute(insert(passes).prefix_with("OR IGNORE").values(rows.pass_to_row(job_id, opened)))
    connection.execute(
        update(jobs)
        .where(jobs.c.id == job_id, jobs.c.passes_opened <= opened.index)
        .values(passes_opened=opened.index + 1)
    )


def commit_tiles(connection: Connection, commits: Sequence[TileCommit], ended: Sequence[int]) -> list[bool]:
    """Take the tiles whose lease stands; returns for each whether it was taken. Then end the leases `ended`."""
    fences = {commit.fence for commit in commits}
    standing = set(connection.execute(select(leases.c.fence).where(leases.c.fence.in_(fences))).scalars())
    taken = [commit for commit in commits if commit.fence in standing]
    if taken:
        connection.execute(
            insert(tiles),
            [{"job_id": c.job_id, "pass_index": c.pass_index, "tile": c.tile, "sha256": c.sha256} for c in taken],
        )
    for job_id in Counter(commit.job_id for commit in taken):
        _count_tiles(connection, job_id, [commit for commit in taken if commit.job_id == job_id])
    if ended:
        connection.execute(delete(leases).where(leases.c.fence.in_(ended)))
    return [commit.fence in standing for commit in commits]


def _count_tiles(connection: Connection, job_id: str, taken: Sequence[TileCommit]) -> None:
    """Add one job's tiles to its counters, its events and what its owner used."""
    samples = sum(commit.samples for commit in taken)
    owner = connection.execute(
        update(jobs)
        .where(jobs.c.id == job_id)
        .values(
            tiles_done=jobs.c.tiles_done + len(taken),
            samples_done=jobs.c.samples_done + samples,
            rays=jobs.c.rays + sum(commit.rays for commit in taken),
            non_finite_samples=jobs.c.non_finite_samples + sum(commit.non_finite_samples for commit in taken),
        )
        .returning(jobs.c.owner)
    ).scalar_one()
    if owner is not None:
        note_usage(connection, owner, 0, samples)
    told = [
        (
            EventKind.TILE,
            {
                "pass": commit.pass_index + 1,
                "x": commit.column,
                "y": commit.row,
                "rect": [commit.rect.x, commit.rect.y, commit.rect.width, commit.rect.height],
                "seconds": round(commit.seconds, 6),
            },
        )
        for commit in taken
    ]
    append_events(connection, job_id, told)


def record_revision(connection: Connection, fence: int, job_id: str, revision: Revision) -> list[str]:
    """Publish a revision; if it has a film, forget the film before and the tiles that the new one contains.

    Returns the digests of those tiles."""
    require_lease(connection, fence, job_id)
    merged: list[str] = []
    if revision.film is not None:
        connection.execute(update(revisions).where(revisions.c.job_id == job_id).values(film=None))
        contained = (tiles.c.job_id == job_id) & (tiles.c.pass_index < revision.passes)
        merged = list(connection.execute(select(tiles.c.sha256).where(contained)).scalars())
        connection.execute(delete(tiles).where(contained))
    connection.execute(insert(revisions).values(rows.revision_to_row(job_id, revision)))
    connection.execute(update(jobs).where(jobs.c.id == job_id).values(running_s=revision.running_s))
    data = {
        "revision": revision.number,
        "pass": revision.passes,
        "samples": revision.min_samples,
        "error_noise": revision.error_noise,
        "seconds": round(revision.running_s, 6),
    }
    append_events(connection, job_id, [(EventKind.PASS, data)])
    return merged


def count_failure(connection: Connection, job_id: str, crash: bool, running_s: float) -> int:
    """Count one more crash or lack of resources; returns the new count."""
    column = jobs.c.crashes if crash else jobs.c.resource_failures
    changed = connection.execute(
        update(jobs)
        .where(jobs.c.id == job_id)
        .values({column: column + 1, jobs.c.running_s: running_s})
        .returning(column)
    )
    return int(changed.scalar_one())


def warn(connection: Connection, job_id: str, message: str) -> None:
    """Add a warning to the job, unless it is finished or has it already."""
    if find_state(connection, job_id) in TERMINAL_STATES:
        return
    known: list[str] = json.loads(connection.execute(select(jobs.c.warnings).where(jobs.c.id == job_id)).scalar_one())
    if message in known:
        return
    connection.execute(update(jobs).where(jobs.c.id == job_id).values(warnings=json.dumps([*known, message])))
    append_events(connection, job_id, [(EventKind.WARNING, {"message": message})])


def delete_job(connection: Connection, job_id: str) -> None:
    """Forget a finished job; only its id stays, so that asking for it answers 410."""
    state = find_state(connection, job_id)
    if state not in TERMINAL_STATES:
        raise IllegalTransition(f"job {job_id}: state {state}, expected a finished job; cancel it first")
    connection.execute(delete(jobs).where(jobs.c.id == job_id))
    connection.execute(insert(deleted_jobs).values(id=job_id, deleted_at=time.time()))


def revoke_all(connection: Connection) -> None:
    """At start-up: no engine process of an earlier service works for us."""
    connection.execute(delete(leases))
