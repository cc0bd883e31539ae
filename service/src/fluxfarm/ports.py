"""The seams of the service: what the orchestrator asks of a worker pool, a ledger and a blob store.

Values first, then the three roles. Adapters implement the roles; tests replace them.
"""

from collections.abc import AsyncIterable, AsyncIterator, Sequence
from dataclasses import dataclass, field
from enum import StrEnum
from pathlib import Path
from typing import Any, Protocol

from fluxfarm.domain.events import Event
from fluxfarm.domain.goal import Goal, Limits
from fluxfarm.domain.job import JobState
from fluxfarm.domain.scene import SceneBundle
from fluxfarm.domain.schedule import SampleRange
from fluxfarm.domain.tiles import PixelRect, TileGrid

# ---- jobs as they are kept ----


@dataclass(frozen=True, slots=True)
class JobRequest:
    """A checked request: what the owner asked for. `size` (width, height) and `crop` are in pixels."""

    name: str
    bundle: SceneBundle
    builtin: str | None
    size: tuple[int, int] | None
    crop: PixelRect | None
    integrator: str | None
    goal: Goal
    limits: Limits
    priority: int
    seed: int


@dataclass(frozen=True, slots=True)
class SceneFacts:
    """What the engine found in the scene. `scene_spp` is 0 when the file does not say."""

    width: int
    height: int
    crop: PixelRect
    scene_spp: int
    integrator: str
    warnings: tuple[str, ...]
    plan: dict[str, Any]
    seconds: float


@dataclass(frozen=True, slots=True)
class Revision:
    """A published image. Digests name files of the job; `film` is gone once a newer revision is recorded."""

    number: int
    passes: int
    min_samples: int
    max_samples: int
    error_noise: float | None
    mean: tuple[float, float, float]
    non_finite_samples: int
    running_s: float
    exr: str
    exr_bytes: int
    png: str
    film: str | None
    at: float


@dataclass(frozen=True, slots=True)
class JobRecord:
    """A job as the ledger knows it. `facts` and `grid` are None before the scene was prepared."""

    id: str
    state: JobState
    reason: str | None
    request: JobRequest
    created_at: float
    facts: SceneFacts | None
    grid: TileGrid | None
    warnings: tuple[str, ...]
    tiles_done: int
    samples_done: int
    rays: int
    non_finite_samples: int
    passes_opened: int
    running_s: float
    crashes: int
    resource_failures: int
    newest: Revision | None


@dataclass(frozen=True, slots=True)
class StoredTile:
    """A committed tile of a pass that no film contains yet."""

    pass_index: int
    tile: int
    sha256: str


@dataclass(frozen=True, slots=True)
class Unmerged:
    """What a restart needs of a job: samples per pixel in the newest revision, passes opened after it, their tiles."""

    merged_spp: int
    passes: tuple[tuple[int, SampleRange], ...]
    tiles: tuple[StoredTile, ...]


# ---- leases and what comes back ----


@dataclass(frozen=True, slots=True)
class SceneRef:
    """A scene for an engine process. `key` differs whenever anything below differs; zeros and "": as the scene says."""

    key: str
    folder: Path
    entry: str
    width: int
    height: int
    integrator: str


@dataclass(frozen=True, slots=True)
class ImageInfo:
    """Goes into the header of an image."""

    job_id: str
    scene_digest: str
    integrator: str
    seed: int


@dataclass(frozen=True, slots=True)
class Lease:
    """Work for one engine process, complete in itself. `fence` is unique and rises; a revoked fence commits nothing."""

    fence: int
    job_id: str


@dataclass(frozen=True, slots=True)
class PrepareLease(Lease):
    """Read and compile the scene."""

    scene: SceneRef


@dataclass(frozen=True, slots=True)
class RenderLease(Lease):
    """Take `samples` of every pixel of `rects`; `tiles` are the grid's indices of the same tiles."""

    scene: SceneRef
    width: int
    height: int
    integrator: str
    seed: int
    pass_index: int
    samples: SampleRange
    tiles: tuple[int, ...]
    rects: tuple[PixelRect, ...]


@dataclass(frozen=True, slots=True)
class MergeLease(Lease):
    """Add finished tiles to the film and write the film, the image and its preview."""

    width: int
    height: int
    crop: PixelRect
    film_in: Path | None
    tiles: tuple[Path, ...]
    film_out: Path
    exr_out: Path
    png_out: Path
    info: ImageInfo
    passes: int


@dataclass(frozen=True, slots=True)
class WriteTileLease(Lease):
    """Write one rect of the film, with tiles that are not in it yet, as an image of its own."""

    width: int
    height: int
    rect: PixelRect
    film_in: Path | None
    tiles: tuple[Path, ...]
    exr_out: Path
    info: ImageInfo


class FailureKind(StrEnum):
    """Why an engine process refused: only RESOURCE is worth another try elsewhere or later."""

    SCENE = "SCENE"
    RESOURCE = "RESOURCE"
    INTERNAL = "INTERNAL"
    CANCELLED = "CANCELLED"


@dataclass(frozen=True, slots=True)
class Prepared:
    """The scene is compiled."""

    lease: PrepareLease
    facts: SceneFacts


@dataclass(frozen=True, slots=True)
class SamplesTaken:
    """`samples` camera samples of the lease are finished so far."""

    lease: RenderLease
    samples: int


@dataclass(frozen=True, slots=True)
class TileRendered:
    """The tile at `position` of the lease. `seconds` on one thread."""

    lease: RenderLease
    position: int
    sums: bytes
    seconds: float
    rays: int
    non_finite_samples: int


@dataclass(frozen=True, slots=True)
class TilesFinished:
    """Every tile of the lease was reported."""

    lease: RenderLease


@dataclass(frozen=True, slots=True)
class Merged:
    """The files of the lease are written and closed, but not yet synced."""

    lease: MergeLease
    min_samples: int
    max_samples: int
    error_noise: float | None
    mean: tuple[float, float, float]
    non_finite_samples: int


@dataclass(frozen=True, slots=True)
class TileWritten:
    """The image of the tile is written."""

    lease: WriteTileLease


@dataclass(frozen=True, slots=True)
class LeaseFailed:
    """The engine process refused the lease and lives on."""

    lease: Lease
    kind: FailureKind
    message: str


@dataclass(frozen=True, slots=True)
class LeaseLost:
    """The engine process died or was stopped; `blamed` if it was working on this lease when it died."""

    lease: Lease
    reason: str
    blamed: bool


Outcome = Prepared | SamplesTaken | TileRendered | TilesFinished | Merged | TileWritten | LeaseFailed | LeaseLost


@dataclass(frozen=True, slots=True)
class WorkerInfo:
    """One engine process. `leases` are (fence, job id) of the work it holds, oldest first."""

    id: int
    state: str
    pid: int | None
    threads: int
    engine_build: str
    restarts: int
    leases: tuple[tuple[int, str], ...] = field(default=())
    last_words: str = ""


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


# ---- files ----


class BlobStore(Protocol):
    """Files known by the SHA-256 of their content. What was put survives a crash of the machine."""

    async def put_asset(self, sha256: str, chunks: AsyncIterable[bytes]) -> bool:
        """Store an upload; True if it is new. Raises DigestMismatch, TooLarge or DiskFull."""

    def missing_assets(self, digests: Sequence[str]) -> list[str]:
        """Those of `digests` that are not stored, in order, each once."""

    async def put_builtin(self, folder: Path) -> SceneBundle:
        """Store the files of a scene folder whose entry is scene.xml."""

    async def scene_folder(self, bundle: SceneBundle) -> Path:
        """A folder that holds the bundle's files under their own paths."""

    async def put_tiles(self, tiles: Sequence[tuple[str, bytes]]) -> list[str]:
        """Store (job id, sums) in order; returns their digests."""

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


# ---- the ledger ----


@dataclass(frozen=True, slots=True)
class TileCommit:
    """A stored tile that asks to be counted."""

    fence: int
    job_id: str
    pass_index: int
    tile: int
    column: int
    row: int
    rect: PixelRect
    samples: int
    sha256: str
    seconds: float
    rays: int
    non_finite_samples: int


class Ledger(Protocol):
    """The one truth about jobs, durable when a call returns. Writers raise StaleLease and IllegalTransition."""

    async def add_job(self, job_id: str, request: JobRequest, key: str | None, body_sha256: str) -> str:
        """Record a new QUEUED job; returns its id, or that of the job which `key` made before.

        Raises IdempotencyConflict if the key was used with another body."""

    async def change_state(
        self, job_id: str, state: JobState, reason: str | None = None, running_s: float | None = None
    ) -> None:
        """Go to `state`, revoking the job's leases unless it goes on, and tell the watchers."""

    async def record_facts(self, fence: int, job_id: str, facts: SceneFacts, grid: TileGrid) -> None:
        """Record a prepared scene; ends the lease and sets the job RUNNING."""

    def grant(self, fence: int, job_id: str) -> None:
        """Record a lease before its first commit. Does not wait."""

    def open_pass(self, job_id: str, index: int, samples: SampleRange) -> None:
        """Record that a pass began. Does not wait."""

    async def commit_tiles(self, commits: Sequence[TileCommit], ended: Sequence[int]) -> list[bool]:
        """Count stored tiles whose fence is alive, then end the leases `ended`; tells which tiles were taken."""

    async def record_revision(self, fence: int, job_id: str, revision: Revision) -> list[str]:
        """Record a revision and end its lease; returns digests of the tiles that its film contains."""

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
        """The job's passes and tiles that no revision contains yet."""

    async def events_after(self, job_id: str, seq: int, limit: int) -> list[Event]:
        """Up to `limit` events after `seq`, in order."""

    async def revisions(self, job_id: str) -> list[Revision]:
        """All revisions, oldest first."""

    async def highest_fence(self) -> int:
        """The highest fence that any lease ever had."""
