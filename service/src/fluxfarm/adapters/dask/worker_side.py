"""The side of a worker: an engine process that stays, whatever becomes of the connection, and what runs for a service.

The functions at the end are called by name on the worker; they find its one WorkerHost.
"""

import asyncio
import hashlib
import logging
import socket
from collections import deque
from collections.abc import AsyncIterator, Sequence
from dataclasses import replace

import fluxfarm
from fluxfarm.adapters.blobs import FileBlobStore
from fluxfarm.adapters.dask.messages import Greeting, Rendered, RenderedTile
from fluxfarm.adapters.engine.local_pool import LocalPool
from fluxfarm.adapters.engine.process import EngineCommand
from fluxfarm.domain.leases import (
    FailureKind,
    LeaseFailed,
    LeaseLost,
    Outcome,
    RenderLease,
    TileRendered,
    TilesFinished,
)
from fluxfarm.domain.scene import SceneBundle

log = logging.getLogger(__name__)
ENGINE = 1
READY_TIMEOUT_S = 30.0
MOST_CANCELLED = 10_000


class WorkerHost:
    """One engine process and the files of the scenes that it renders."""

    def __init__(self, engine: EngineCommand, max_asset_bytes: int) -> None:
        self._blobs = FileBlobStore(engine.data, max_asset_bytes, durable=False)
        self._pool = LocalPool(engine, 1)
        # By job and fence: fences of two services may be the same.
        self._waiting: dict[tuple[str, int], asyncio.Queue[Outcome]] = {}
        # Leases that were cancelled, maybe before they came.
        self._cancelled: deque[tuple[str, int]] = deque(maxlen=MOST_CANCELLED)
        self._router: asyncio.Task[None] | None = None

    async def start(self) -> None:
        """Start the engine process."""
        await self._pool.start()
        self._router = asyncio.create_task(self._route())

    async def close(self) -> None:
        """End the engine process."""
        if self._router is not None:
            self._router.cancel()
        await self._pool.close()
        self._blobs.close()

    def greeting(self) -> Greeting:
        """What this worker is."""
        (info,) = self._pool.workers()
        return Greeting(
            fluxfarm.__version__,
            socket.gethostname(),
            info.state,
            info.pid,
            info.threads,
            info.engine_build,
            info.restarts,
            info.last_words,
            info.sandbox_missing,
        )

    async def put(self, sha256: str, content: bytes) -> None:
        """Keep a file of a scene, if its digest is what it should be."""

        async def chunks() -> AsyncIterator[bytes]:
            yield content

        await self._blobs.put_asset(sha256, chunks())

    async def render(self, lease: RenderLease, bundle: SceneBundle) -> Rendered:
        """Carry out a lease, unless files of its scene are missing."""
        if missing := self._blobs.missing_assets(list(bundle.files.values())):
            return Rendered(missing=tuple(missing))
        if not await self._engine_is_ready():
            return Rendered(lost=("the engine process of the worker does not start", False))
        folder = await self._blobs.scene_folder(bundle)
        tiles_out = self._blobs.scratch(lease.job_id, str(lease.fence))
        name = (lease.job_id, lease.fence)
        if name in self._cancelled:
            return Rendered(failure=(FailureKind.CANCELLED, "cancelled before it began"))
        lease = replace(lease, scene=replace(lease.scene, folder=folder), tiles_out=tiles_out)
        outcomes: asyncio.Queue[Outcome] = asyncio.Queue()
        self._waiting[name] = outcomes
        try:
            self._pool.submit(ENGINE, lease)
            return await self._collect(outcomes)
        finally:
            del self._waiting[name]
            for position in range(len(lease.tiles)):
                lease.file(position).unlink(missing_ok=True)

    def cancel(self, job_id: str, fences: Sequence[int]) -> None:
        """Stop all work of a job; leases with these fences that are still on their way do not begin."""
        self._cancelled.extend((job_id, fence) for fence in fences)
        self._pool.cancel(job_id)

    async def _collect(self, outcomes: "asyncio.Queue[Outcome]") -> Rendered:
        tiles: list[RenderedTile] = []
        while True:
            outcome = await outcomes.get()
            if isinstance(outcome, TileRendered):
                content = outcome.lease.file(outcome.position).read_bytes()
                if len(content) != outcome.size:
                    failure = (FailureKind.RESOURCE, f"a tile has {len(content)} bytes, written were {outcome.size}")
                    return Rendered(tuple(tiles), failure=failure)
                sha256 = hashlib.sha256(content).hexdigest()
                figures = (outcome.seconds, outcome.rays, outcome.non_finite_samples)
                tiles.append(RenderedTile(outcome.position, content, sha256, *figures))
            elif isinstance(outcome, TilesFinished):
                return Rendered(tuple(tiles))
            elif isinstance(outcome, LeaseFailed):
                return Rendered(tuple(tiles), failure=(outcome.kind, outcome.message))
            elif isinstance(outcome, LeaseLost):
                return Rendered(tuple(tiles), lost=(outcome.reason, outcome.blamed))

    async def _route(self) -> None:
        async for outcome in self._pool.outcomes():
            if outcome is not None:
                waiting = self._waiting.get((outcome.lease.job_id, outcome.lease.fence))
                if waiting is not None:
                    waiting.put_nowait(outcome)

    async def _engine_is_ready(self) -> bool:
        end = asyncio.get_running_loop().time() + READY_TIMEOUT_S
        while self._pool.workers()[0].state not in ("READY", "WORKING"):
            if asyncio.get_running_loop().time() > end:
                return False
            await asyncio.sleep(0.05)
        return True


# The one of this process; `fluxfarm worker` sets it.
host: WorkerHost | None = None


def _host() -> WorkerHost:
    assert host is not None, "only a process of `fluxfarm worker` renders"
    return host


async def greet() -> Greeting:
    """What this worker is."""
    return _host().greeting()


async def put(sha256: str, content: bytes) -> None:
    """Keep a file of a scene."""
    await _host().put(sha256, content)


async def render(lease: RenderLease, bundle: SceneBundle) -> Rendered:
    """Carry out a lease."""
    return await _host().render(lease, bundle)


async def cancel(job_id: str, fences: Sequence[int]) -> None:
    """Stop all work of a job."""
    _host().cancel(job_id, fences)
