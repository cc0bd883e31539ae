"""The seams of the service: what the orchestrator asks of a worker pool, a blob store and a ledger.

Adapters implement the roles; tests replace them. The values that cross them are in `domain/leases.py` and
`domain/records.py`.
"""

from collections.abc import AsyncIterable, AsyncIterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Protocol

from fluxfarm.domain.access import ApiKey, Usage
from fluxfarm.domain.events import Event
from fluxfarm.domain.job import JobState
from fluxfarm.domain.leases import Lease, Outcome
from fluxfarm.domain.records import (
    JobRecord,
    JobRequest,
    OpenedPass,
    Revision,
    SceneFacts,
    TileCommit,
    TileFile,
    Unmerged,
)
from fluxfarm.domain.scene import SceneBundle
from fluxfarm.domain.tiles import TileGrid


@dataclass(frozen=True, slots=True)
class WorkerInfo:
    """One engine process. `leases` are (fence, job id) of the work it holds, oldest first; `sandbox_missing` says what
    of its sandbox the kernel does not hold. `host` is "" on this machine. Those that `prepare` also merge; only those
    that `render` take samples."""

    id: int
    state: str
    pid: int | None
    threads: int
    engine_build: str
    restarts: int
    leases: tuple[tuple[int, str], ...] = field(default=())
    last_words: str = ""
    sandbox_missing: tuple[str, ...] = field(default=())
    host: str = ""
    prepares: bool = True
    renders: bool = True


class WorkerPool(Protocol):
    """Runs leases on engine processes and replaces those that die."""

    async def start(self) -> None:
        """Start the processes; returns without waiting for them to be ready."""

    def workers(self) -> list[WorkerInfo]:
        """All processes as they are now."""

    def submit(self, worker_id: int, lease: Lease) -> None:
        """Hand `lease` to a ready process; its outcomes follow."""

    def cancel(self, job_id: str) -> None:
        """Stop all work of a job; a process that does not stop in time is replaced."""

    def outcomes(self) -> AsyncIterator[Outcome | None]:
        """What the processes report, in order; None when only `workers` changed. One consumer."""

    async def close(self) -> None:
        """End all processes and wait until they are gone."""


class BlobStore(Protocol):
    """Files known by the SHA-256 of their content. What was put survives a crash of the machine."""

    async def put_asset(self, sha256: str, chunks: AsyncIterable[bytes]) -> bool:
        """Store an upload; True if it is new. Raises DigestMismatch, TooLarge or DiskFull."""

    def free_bytes(self) -> int:
        """Room on the disk."""

    def missing_assets(self, digests: Sequence[str]) -> list[str]:
        """Those of `digests` that are not stored, in order, each once."""

    async def put_builtin(self, folder: Path) -> SceneBundle:
        """Store the files of a scene folder whose entry is scene.xml."""

    async def scene_folder(self, bundle: SceneBundle) -> Path:
        """A folder that holds the bundle's files under their own paths."""

    async def adopt_tiles(self, tiles: Sequence[TileFile]) -> list[str | OSError]:
        """Sync scratch files and move them to their digests; returns these in order, or why a file was dropped."""

    def tile(self, job_id: str, sha256: str) -> Path:
        """Path of a stored tile."""

    def scratch(self, job_id: str, name: str) -> Path:
        """A path where an engine process may write; swept at the next start."""

    async def adopt(self, job_id: str, scratch: Path) -> tuple[str, int]:
        """Sync a scratch file and move it to its digest; returns the digest and the size in bytes."""

    def output(self, job_id: str, sha256: str) -> Path:
        """Path of an adopted file."""

    async def drop(self, paths: Sequence[Path]) -> None:
        """Remove files that nothing refers to any more."""

    async def drop_job(self, job_id: str) -> None:
        """Remove all files of a job."""


class Ledger(Protocol):
    """The one truth about jobs, durable when a call returns. Writers raise StaleLease and IllegalTransition."""

    async def add_job(
        self, job_id: str, request: JobRequest, key: str | None, body_sha256: str, owner: ApiKey | None = None
    ) -> str:
        """Record a new QUEUED job of `owner`; returns its id, or that of the job which the Idempotency-Key `key` of the
        same owner made before.

        Raises IdempotencyConflict if the key was used with another body, QuotaExceeded if the owner has its fill."""

    async def change_state(
        self, job_id: str, state: JobState, reason: str | None = None, running_s: float | None = None
    ) -> None:
        """Go to `state`, revoking the job's leases unless it goes on, and tell the watchers."""

    async def record_facts(self, fence: int, job_id: str, facts: SceneFacts, grid: TileGrid) -> None:
        """Record a prepared scene; ends the lease and sets the job RUNNING."""

    def grant(self, fence: int, job_id: str) -> None:
        """Record a lease before its first commit. Does not wait."""

    def open_pass(self, job_id: str, opened: OpenedPass) -> None:
        """Record that a pass began. Does not wait."""

    async def commit_tiles(self, commits: Sequence[TileCommit], ended: Sequence[int]) -> list[bool]:
        """Count stored tiles whose fence is alive, then end the leases `ended`; tells which tiles were taken."""

    async def record_revision(self, fence: int, job_id: str, revision: Revision) -> list[str]:
        """Record a revision and end its lease; returns digests of the tiles that its film, if any, contains."""

    async def count_failure(self, job_id: str, crash: bool, running_s: float) -> int:
        """Count a crash or a lack of resources of a job; returns the count so far."""

    async def warn(self, job_id: str, message: str) -> None:
        """Add a warning to the job and its events."""

    async def delete_job(self, job_id: str) -> None:
        """Forget a finished job but for its id."""

    async def job(self, job_id: str) -> JobRecord:
        """The job; raises JobNotFound, or Gone if it was deleted."""

    async def jobs(self, states: Sequence[JobState] = (), limit: int | None = None) -> list[JobRecord]:
        """Jobs, newest first; all states if none is named."""

    async def counts(self) -> dict[str, int]:
        """Number of jobs by state."""

    async def unmerged(self, job_id: str) -> Unmerged:
        """The job's passes that no revision contains yet, its film, and the tiles that no film contains yet."""

    async def events_after(self, job_id: str, seq: int, limit: int) -> list[Event]:
        """Up to `limit` events after `seq`, in order."""

    async def revisions(self, job_id: str) -> list[Revision]:
        """All revisions, oldest first."""

    async def add_key(self, key: ApiKey, sha256: str) -> None:
        """Keep an API key by the SHA-256 of its secret."""

    async def drop_key(self, key_id: str) -> bool:
        """Forget an API key; False if there is none of that id."""

    async def keys(self) -> dict[str, ApiKey]:
        """All API keys by the SHA-256 of their secrets, oldest first."""

    async def usage(self, key_id: str) -> tuple[int, list[Usage]]:
        """Unfinished jobs of a key, and what it used in the last 24 hours, oldest hour first."""

    async def bytes_left(self, key: ApiKey) -> int | None:
        """How much the key may still upload (None: any); raises QuotaExceeded if nothing."""

    async def note_upload(self, key_id: str, sent_bytes: int) -> None:
        """Count what a key has uploaded."""

    async def highest_fence(self) -> int:
        """The highest fence that any lease ever had."""
