"""How many workers one service process keeps busy, by itself: an engine that sleeps stands for 64 workers.

    service_capacity.py [--workers 64] [--tile-seconds 0.1] [--tiles 100000]

Ledger, files and their syncs are real; only the pixels are not. Busy is the part of the workers' time, from the first
tile to the last, in which they had one to render.
"""

import argparse
import asyncio
import hashlib
import resource
import tempfile
import time
from collections.abc import AsyncIterator
from dataclasses import dataclass, field
from pathlib import Path

from fluxfarm.adapters.blobs import FileBlobStore
from fluxfarm.adapters.ledger import SqliteLedger
from fluxfarm.domain.events import EventKind
from fluxfarm.domain.goal import Goal, Limits
from fluxfarm.domain.job import TERMINAL_STATES
from fluxfarm.domain.leases import (
    Lease,
    Merged,
    MergeLease,
    Outcome,
    Prepared,
    PrepareLease,
    RenderLease,
    TileRendered,
    TilesFinished,
)
from fluxfarm.domain.records import JobRequest, SceneFacts
from fluxfarm.domain.scene import SceneBundle
from fluxfarm.domain.tiles import PixelRect
from fluxfarm.orchestrator import Orchestrator
from fluxfarm.orchestrator.orchestrator import OrchestratorSettings
from fluxfarm.ports import WorkerInfo

TILE_SIDE = 8
SCENE = b"asleep"


@dataclass(slots=True)
class Sleeper:
    id: int
    leases: dict[int, Lease] = field(default_factory=dict)
    waiting: "asyncio.Queue[Lease]" = field(default_factory=asyncio.Queue)
    busy_s: float = 0.0


class SleepingPool:
    """A WorkerPool whose workers sleep for each tile."""

    def __init__(self, workers: int, tile_s: float, side: int) -> None:
        self._tile_s = tile_s
        self._side = side
        self.sleepers = [Sleeper(number) for number in range(1, workers + 1)]
        self._outcomes: asyncio.Queue[Outcome | None] = asyncio.Queue()
        self._tasks: list[asyncio.Task[None]] = []
        self.first: float | None = None
        self.last = 0.0

    async def start(self) -> None:
        self._tasks = [asyncio.create_task(self._work(sleeper)) for sleeper in self.sleepers]

    def workers(self) -> list[WorkerInfo]:
        return [
            WorkerInfo(
                id=sleeper.id,
                state="WORKING" if sleeper.leases else "READY",
                pid=1,
                threads=1,
                engine_build="asleep",
                restarts=0,
                leases=tuple((lease.fence, lease.job_id) for lease in sleeper.leases.values()),
            )
            for sleeper in self.sleepers
        ]

    def submit(self, worker_id: int, lease: Lease) -> None:
        sleeper = self.sleepers[worker_id - 1]
        sleeper.leases[lease.fence] = lease
        sleeper.waiting.put_nowait(lease)

    def cancel(self, job_id: str) -> None: ...

    async def outcomes(self) -> AsyncIterator[Outcome | None]:
        while True:
            yield await self._outcomes.get()

    async def close(self) -> None:
        for task in self._tasks:
            task.cancel()

    async def _work(self, sleeper: Sleeper) -> None:
        while True:
            lease = await sleeper.waiting.get()
            if isinstance(lease, RenderLease):
                await self._render(sleeper, lease)
                last: Outcome = TilesFinished(lease)
            elif isinstance(lease, MergeLease):
                last = merged(lease)
            else:
                assert isinstance(lease, PrepareLease)
                rect = PixelRect(0, 0, self._side, self._side)
                last = Prepared(lease, SceneFacts(self._side, self._side, rect, 1, "path", (), {}, 0.0))
            del sleeper.leases[lease.fence]
            self._outcomes.put_nowait(last)

    async def _render(self, sleeper: Sleeper, lease: RenderLease) -> None:
        for position, tile in enumerate(lease.tiles):
            self.first = self.first or time.monotonic()
            await asyncio.sleep(self._tile_s)
            content = f"{lease.pass_index} {tile}".encode()
            lease.file(position).write_bytes(content)
            sleeper.busy_s += self._tile_s
            self.last = time.monotonic()
            self._outcomes.put_nowait(TileRendered(lease, position, len(content), self._tile_s, 1, 0))


def merged(lease: MergeLease) -> Merged:
    for path in (lease.exr_out, lease.png_out, lease.film_out):
        if path is not None:
            path.write_bytes(b"merged")
    return Merged(lease, 1, 1, 1.0, 0.1, 0.0, (0.0, 0.0, 0.0), 0, 0.01, None, None, None, None, None)


async def measure(options: argparse.Namespace, folder: Path) -> None:
    columns = round(options.tiles**0.5)
    side = columns * TILE_SIDE
    pool = SleepingPool(options.workers, options.tile_seconds, side)
    ledger, blobs = SqliteLedger(folder / "ledger.sqlite3"), FileBlobStore(folder, 1 << 20)
    service = Orchestrator(ledger, blobs, pool, OrchestratorSettings(TILE_SIDE, 1.0, side * side))
    await service.start()
    sha256 = hashlib.sha256(SCENE).hexdigest()

    async def chunks() -> AsyncIterator[bytes]:
        yield SCENE

    await blobs.put_asset(sha256, chunks())
    bundle = SceneBundle("scene.xml", {"scene.xml": sha256})
    request = JobRequest("asleep", bundle, None, (side, side), None, None, Goal(spp=1), Limits(), 0, 0)
    before = resource.getrusage(resource.RUSAGE_SELF)
    job_id, _ = await service.create(request, None, "", None)
    while True:
        ticket = service.watch.ticket(job_id)
        job = await ledger.job(job_id)
        if job.state in TERMINAL_STATES:
            break
        await ticket.wait()
    after = resource.getrusage(resource.RUSAGE_SELF)
    assert job.state == "SUCCEEDED", job.reason
    assert pool.first is not None
    wall = pool.last - pool.first
    busy = sum(sleeper.busy_s for sleeper in pool.sleepers) / (wall * options.workers)
    cpu = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    tiles, seq, gaps = 0, 0, 0
    while page := await ledger.events_after(job_id, seq, 5000):
        for event in page:
            gaps += event.seq != seq + 1
            seq = event.seq
            tiles += event.kind is EventKind.TILE
    number = sum(service.tallies.commit_seconds.counts)
    print(f"{tiles} tiles of {options.tile_seconds:g} s on {options.workers} workers in {wall:.1f} s: {busy:.1%} busy")
    print(f"{tiles / wall:.0f} tiles a second, {cpu / wall:.0%} of a core, {1e3 * cpu / tiles:.2f} ms of it for a tile")
    print(f"{number} commits of {tiles / number:.0f} tiles, {number / wall:.1f} a second")
    print(f"{seq} events, {gaps} gaps; memory {before.ru_maxrss >> 10} MiB before, {after.ru_maxrss >> 10} MiB at most")
    await service.close()
    ledger.close()
    blobs.close()


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--workers", type=int, default=64)
    parser.add_argument("--tile-seconds", type=float, default=0.1)
    parser.add_argument("--tiles", type=int, default=100_000)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory(prefix="fluxfarm-") as folder:
        asyncio.run(measure(options, Path(folder)))


if __name__ == "__main__":
    main()
