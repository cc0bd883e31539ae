"""Which lease goes to which engine process next.

Each process holds a window of two leases, so that it never waits for us. Jobs are asked in the order of priority and
age; a job that ended a process before shares no window with another job, so that it cannot take one down with it.
"""

import asyncio
import hashlib
import json
import time
from collections.abc import Callable, Sequence
from dataclasses import asdict
from pathlib import Path

from fluxfarm.domain.job import JobState
from fluxfarm.domain.leases import (
    ImageInfo,
    Lease,
    LeaseFailed,
    LeaseLost,
    MergeLease,
    Outcome,
    Picture,
    PrepareLease,
    SceneRef,
    WriteTileLease,
)
from fluxfarm.domain.records import AUTO, JobRequest
from fluxfarm.errors import EngineTrouble
from fluxfarm.orchestrator.committer import Committer
from fluxfarm.orchestrator.run import JobRun
from fluxfarm.orchestrator.tallies import Tallies
from fluxfarm.ports import BlobStore, Ledger, WorkerInfo, WorkerPool

WINDOW = 2
# Above this, rendering waits until the disk has caught up.
MOST_BACKLOG_BYTES = 128 << 20


class Dispatcher:
    """Hands out leases; owned and called by the orchestrator's task alone."""

    def __init__(
        self,
        ledger: Ledger,
        blobs: BlobStore,
        pool: WorkerPool,
        committer: Committer,
        tallies: Tallies,
        lease_s: float,
    ) -> None:
        self._ledger = ledger
        self._tallies = tallies
        self._blobs = blobs
        self._pool = pool
        self._committer = committer
        self._lease_s = lease_s
        self._errands: list[WriteTileLease] = []
        self._waiting: dict[int, asyncio.Future[None]] = {}
        self.next_fence = 1

    def new_fence(self) -> int:
        """A fence that no lease had before."""
        self.next_fence += 1
        return self.next_fence - 1

    async def errand(self, lease: WriteTileLease, wake: Callable[[], None]) -> None:
        """Have one tile written soon; raises EngineTrouble."""
        done: asyncio.Future[None] = asyncio.get_running_loop().create_future()
        self._waiting[lease.fence] = done
        self._errands.append(lease)
        wake()
        try:
            await done
        finally:
            self._waiting.pop(lease.fence, None)
            self._errands = [errand for errand in self._errands if errand is not lease]

    def settle(self, outcome: Outcome) -> None:
        """An errand came to its end."""
        done = self._waiting.get(outcome.lease.fence)
        if done is None or done.done():
            return
        if isinstance(outcome, LeaseFailed):
            done.set_exception(EngineTrouble(outcome.message))
        elif isinstance(outcome, LeaseLost):
            done.set_exception(EngineTrouble(outcome.reason))
        else:
            done.set_result(None)

    async def fill(self, runs: Sequence[JobRun]) -> None:
        """Hand out leases until no process has room or no job has work."""
        while True:
            workers = [w for w in self._pool.workers() if w.state in ("READY", "WORKING") and len(w.leases) < WINDOW]
            for worker in sorted(workers, key=lambda worker: len(worker.leases)):
                lease = await self._next_lease(worker, runs)
                if lease is not None:
                    self._pool.submit(worker.id, lease)
                    break
            else:
                return

    async def _next_lease(self, worker: WorkerInfo, runs: Sequence[JobRun]) -> Lease | None:
        if self._errands and worker.prepares:
            return self._errands.pop(0)
        by_id = {run.id: run for run in runs}
        others = {job_id for _, job_id in worker.leases}
        if any(job_id in by_id and by_id[job_id].crashes for job_id in others):
            runs = [by_id[job_id] for job_id in others if job_id in by_id]
        for run in runs:
            if run.crashes and others - {run.id}:
                continue
            lease = await self._lease_of(run, worker)
            if lease is not None:
                return lease
        return None

    async def _lease_of(self, run: JobRun, worker: WorkerInfo) -> Lease | None:
        """The next lease of one job, recorded in the ledger before it is handed out; None if it has no work now."""
        lease: Lease | None = None
        if run.state is JobState.QUEUED and worker.prepares:
            await self._ledger.change_state(run.id, JobState.PREPARING)
            run.state = JobState.PREPARING
            self._tallies.queue_seconds.add(max(time.time() - run.created_at, 0.0))
            lease = PrepareLease(self.new_fence(), run.id, run.scene)
            run.single_lease = lease.fence
        elif run.state in (JobState.RUNNING, JobState.FINALIZING):
            lease = self._merge_lease(run) if worker.prepares else None
            if lease is None and worker.renders and self._committer.backlog_bytes < MOST_BACKLOG_BYTES:
                lease = self._render_lease(run, worker)
        if lease is not None:
            self._ledger.grant(lease.fence, run.id)
        return lease

    def _render_lease(self, run: JobRun, worker: WorkerInfo) -> Lease | None:
        opened = run.open_pass(time.monotonic())
        if opened is not None:
            self._ledger.open_pass(run.id, opened)
        tiles_out = self._blobs.scratch(run.id, str(self.next_fence))
        rendering = sum(1 for other in self._pool.workers() if other.renders)
        lease = run.take_lease(self.next_fence, worker.threads, rendering, self._lease_s, tiles_out)
        if lease is not None:
            self.new_fence()
        return lease

    def _merge_lease(self, run: JobRun) -> MergeLease | None:
        ready = run.mergeable(time.monotonic())
        if run.single_lease is not None or not ready or run.facts is None or run.grid is None:
            return None
        fence, facts = self.new_fence(), run.facts
        run.single_lease = fence
        tiles = run.loose_tiles + tuple(sha256 for work in ready for sha256 in work.tiles())
        return MergeLease(
            fence=fence,
            job_id=run.id,
            width=facts.width,
            height=facts.height,
            crop=run.grid.crop,
            film_in=None if run.film is None else self._blobs.output(run.id, run.film),
            tiles=tuple(self._blobs.tile(run.id, sha256) for sha256 in tiles),
            film_out=self._blobs.scratch(run.id, f"{fence}.film") if run.wants_film(ready) else None,
            exr_out=self._blobs.scratch(run.id, f"{fence}.exr"),
            png_out=self._blobs.scratch(run.id, f"{fence}.png"),
            info=ImageInfo(run.id, run.request.bundle.digest(), facts.integrator, run.request.seed),
            passes=ready[-1].index + 1,
            decision=run.decision(ready),
        )


def scene_ref(request: JobRequest, folder: Path, chosen: str | None) -> SceneRef:
    """The scene of a request as engine processes know it: the key covers the files and everything set over them.
    `chosen` is the method that was chosen for the job before, if it was."""
    width, height = request.size or (0, 0)
    settled: list[object] = [request.bundle.digest(), width, height, request.method]
    picture = None
    if request.method == AUTO:
        picture = Picture(request.crop, request.seed, request.goal)
        settled.append(asdict(picture))
    key = hashlib.sha256(json.dumps(settled).encode()).hexdigest()
    scene = SceneRef(key, folder, request.bundle.entry, width, height, request.method, request.bundle, picture)
    return scene if chosen is None else scene.with_method(chosen)
