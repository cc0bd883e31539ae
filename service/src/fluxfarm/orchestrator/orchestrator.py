"""The one task that owns the state of unfinished jobs.

Everything that can change a job - a command of its owner, an outcome of an engine process, a committed batch - is put
into one inbox and handled to its end before the next. The ledger is changed first, memory after it.
"""

import asyncio
import logging
import time
import uuid
from collections.abc import Awaitable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TypeVar

from fluxfarm.domain.access import ApiKey
from fluxfarm.domain.goal import ERROR_TILE
from fluxfarm.domain.job import JobState
from fluxfarm.domain.leases import (
    FailureKind,
    Lease,
    LeaseFailed,
    LeaseLost,
    Merged,
    MergeLease,
    Outcome,
    Prepared,
    PrepareLease,
    RenderLease,
    SamplesTaken,
    TileRendered,
    TilesFinished,
    WriteTileLease,
)
from fluxfarm.domain.progress import Progress
from fluxfarm.domain.records import JobRecord, JobRequest, Revision, TileCommit, TileFile
from fluxfarm.domain.scene import check_bundle
from fluxfarm.domain.tiles import PixelRect, TileGrid
from fluxfarm.errors import AssetsMissing, EngineTrouble, StaleLease
from fluxfarm.failpoints import reach
from fluxfarm.orchestrator.committer import Batch, Committer
from fluxfarm.orchestrator.disk_guard import DiskGuard
from fluxfarm.orchestrator.dispatch import Dispatcher
from fluxfarm.orchestrator.inbox import Inbox
from fluxfarm.orchestrator.publisher import publish
from fluxfarm.orchestrator.run import JobRun
from fluxfarm.orchestrator.runs import Runs
from fluxfarm.orchestrator.status import progress_of
from fluxfarm.orchestrator.tallies import Tallies
from fluxfarm.orchestrator.tile_images import tile_lease
from fluxfarm.orchestrator.watch import Watch
from fluxfarm.ports import BlobStore, Ledger, WorkerPool

T = TypeVar("T")
log = logging.getLogger(__name__)

TILE_IMAGE_TIMEOUT_S = 30.0
DISK_LOOK_S = 1.0
# Under load the inbox is never empty, and the engine processes must not wait for that.
MESSAGES_PER_DISPATCH = 32


@dataclass(frozen=True, slots=True)
class OrchestratorSettings:
    """`tile_size` in pixels; `lease_s` is how long a lease should take; frames beyond `max_pixels` are refused; with
    less than `least_free_bytes` on the disk jobs wait."""

    tile_size: int = 64
    lease_s: float = 1.0
    max_pixels: int = 1 << 27
    least_free_bytes: int = 256 << 20


class Orchestrator:
    """Start it with `start`, then give it commands from the same event loop."""

    def __init__(self, ledger: Ledger, blobs: BlobStore, pool: WorkerPool, settings: OrchestratorSettings) -> None:
        self._ledger = ledger
        self._blobs = blobs
        self._pool = pool
        self._settings = settings
        self._inbox = Inbox()
        self._committer = Committer(ledger, blobs, self._report_batch)
        self.tallies = Tallies()
        self._dispatcher = Dispatcher(ledger, blobs, pool, self._committer, self.tallies, settings.lease_s)
        self._tasks: set[asyncio.Task[None]] = set()
        self.watch = Watch()
        self._runs = Runs(ledger, blobs, pool, self.watch)
        self._disk = DiskGuard(ledger, blobs, self._runs, settings.least_free_bytes)

    # ---- life ----

    async def start(self) -> None:
        """Resume every unfinished job and begin to work."""
        self._dispatcher.next_fence = await self._ledger.highest_fence() + 1
        await self._runs.adopt_all()
        await self._pool.start()
        for work in (self._handle_inbox(), self._hear_outcomes(), self._committer.run(), self._watch_disk()):
            self._background(work)

    async def close(self) -> None:
        """Stop working; unfinished jobs go on at the next start."""
        self.watch.close()
        await self._pool.close()
        for task in self._tasks:
            task.cancel()
        await asyncio.gather(*self._tasks, return_exceptions=True)

    # ---- commands ----

    async def create(
        self, request: JobRequest, key: str | None, body_sha256: str, owner: ApiKey | None
    ) -> tuple[str, bool]:
        """Accept a job; returns its id and whether it is new. When this returns, the job survives everything.

        Raises BadBundle, AssetsMissing, IdempotencyConflict or QuotaExceeded."""
        check_bundle(request.bundle)
        missing = set(self._blobs.missing_assets(list(request.bundle.files.values())))
        if missing:
            raise AssetsMissing({path: sha for path, sha in request.bundle.files.items() if sha in missing})
        wanted_id = str(uuid.uuid4())
        job_id = await self._ledger.add_job(wanted_id, request, key, body_sha256, owner)
        reach("job-recorded")
        if job_id == wanted_id:
            await self._inbox.ask(lambda: self._runs.adopt(job_id))
        return job_id, job_id == wanted_id

    async def cancel(self, job_id: str) -> None:
        """Give a job up; when this returns, no tile of it is committed any more. Again: no effect."""
        await self._inbox.ask(lambda: self._runs.halt(job_id, JobState.CANCELLED))

    async def pause(self, job_id: str) -> None:
        """Stop a job for now. Again on a paused job: no effect."""
        await self._inbox.ask(lambda: self._runs.halt(job_id, JobState.PAUSED))

    async def resume(self, job_id: str) -> None:
        """Let a paused job go on. On a job that is not paused: IllegalTransition."""
        await self._inbox.ask(lambda: self._runs.resume(job_id))

    async def delete(self, job_id: str) -> None:
        """Remove a job with all of its files, cancelling it first if it is unfinished."""
        await self._inbox.ask(lambda: self._runs.delete(job_id))

    async def tile_image(self, job_id: str, column: int, row: int) -> Path:
        """Have one tile written as an image of its own; the caller removes the file.

        Raises NotYetThere, TileOutsideFrame or EngineTrouble."""
        for attempt in (1, 2):
            fence = self._dispatcher.new_fence()
            lease = await tile_lease(self._ledger, self._blobs, job_id, (column, row), fence)
            try:
                await asyncio.wait_for(self._dispatcher.errand(lease, self._inbox.wake), TILE_IMAGE_TIMEOUT_S)
                return lease.exr_out
            except TimeoutError:
                raise EngineTrouble(
                    f"tile {column}-{row}: no engine process wrote it in {TILE_IMAGE_TIMEOUT_S:g} s"
                ) from None
            except EngineTrouble:  # its film may have been replaced meanwhile: look again, once
                if attempt == 2:
                    raise
        raise AssertionError("unreachable")

    # ---- questions ----

    def progress(self, record: JobRecord) -> Progress:
        """How far a job is, including samples that no committed tile contains yet."""
        return progress_of(record, self._runs.get(record.id), time.monotonic())

    def running_s(self, record: JobRecord) -> float:
        """Seconds that a job has spent in RUNNING, up to now."""
        run = self._runs.get(record.id)
        return record.running_s if run is None else run.running_s(time.monotonic())

    # ---- the inbox ----

    def _background(self, work: Awaitable[None]) -> None:
        task = asyncio.ensure_future(work)
        self._tasks.add(task)
        task.add_done_callback(self._tasks.discard)

    async def _handle_inbox(self) -> None:
        handled = 0
        while True:
            work = await self._inbox.next()
            handled += 1
            try:
                await work()
                if self._inbox.empty or handled % MESSAGES_PER_DISPATCH == 0:
                    await self._dispatch()
            except StaleLease as error:
                log.info("stale work dropped", extra={"reason": str(error)})
            except Exception:
                log.exception("the orchestrator could not handle a message")

    async def _hear_outcomes(self) -> None:
        async for outcome in self._pool.outcomes():
            if outcome is None:
                self._inbox.wake()
            else:
                self._inbox.put(lambda outcome=outcome: self._on_outcome(outcome))  # type: ignore[misc]

    async def _watch_disk(self) -> None:
        while True:
            self._inbox.put(self._disk.look)
            await asyncio.sleep(DISK_LOOK_S)

    def _report_batch(self, batch: Batch) -> None:
        self._inbox.put(lambda: self._on_batch(batch))

    async def _dispatch(self) -> None:
        """Fill the engine processes' windows, then see which jobs have come to their end."""
        await self._dispatcher.fill(self._runs.in_order())
        for run in self._runs.in_order():
            if run.state is JobState.RUNNING and run.stop is not None and run.all_passes_complete:
                await self._runs.change(run, JobState.FINALIZING)
            if run.state is JobState.FINALIZING and run.all_merged:
                await self._runs.finish(run)
                if run.newest is not None and run.newest.error_noise is not None:
                    self.tallies.errors.add(run.newest.error_noise)

    # ---- outcomes ----

    async def _on_outcome(self, outcome: Outcome) -> None:
        """One report of an engine process; what belongs to a job that was stopped meanwhile is dropped."""
        run = self._runs.get(outcome.lease.job_id)
        if isinstance(outcome.lease, WriteTileLease):
            self._dispatcher.settle(outcome)
        elif run is None or not run.has_lease(outcome.lease.fence):
            self._drop_stale(outcome)
        elif isinstance(outcome, TileRendered):
            self._on_tile(run, outcome)
        elif isinstance(outcome, SamplesTaken):
            run.note_samples(outcome.lease, outcome.samples)
        elif isinstance(outcome, TilesFinished):
            self._committer.end(outcome.lease.fence)
        elif isinstance(outcome, Prepared):
            await self._on_prepared(run, outcome)
        elif isinstance(outcome, Merged):
            run.end_merge(outcome.seconds, time.monotonic())
            self._background(self._publish(run, outcome))
        elif isinstance(outcome, LeaseLost):
            await self._on_fault(run, outcome.lease, FailureKind.INTERNAL if outcome.blamed else None, outcome.reason)
        elif isinstance(outcome, LeaseFailed):
            kind = None if outcome.kind is FailureKind.CANCELLED else outcome.kind
            await self._on_fault(run, outcome.lease, kind, outcome.message)

    def _drop_stale(self, outcome: Outcome) -> None:
        """Forget what a revoked lease brings, and the files that it wrote."""
        if isinstance(outcome, TileRendered):
            self.tallies.stale_tiles += 1
            self._background(self._blobs.drop([outcome.lease.file(outcome.position)]))
        elif isinstance(outcome, Merged | LeaseFailed | LeaseLost):
            self._background(self._blobs.drop(_outputs(outcome.lease)))

    def _on_tile(self, run: JobRun, outcome: TileRendered) -> None:
        lease, rect = outcome.lease, outcome.lease.rects[outcome.position]
        assert run.grid is not None
        row, column = divmod(lease.tiles[outcome.position], run.grid.columns)
        run.note_cost(lease, outcome.position, outcome.seconds)
        self.tallies.tile_seconds.add(outcome.seconds)
        commit = TileCommit(
            fence=lease.fence,
            job_id=lease.job_id,
            pass_index=lease.pass_index,
            tile=lease.tiles[outcome.position],
            column=column,
            row=row,
            rect=rect,
            samples=rect.area * lease.samples.count,
            sha256="",
            seconds=outcome.seconds,
            rays=outcome.rays,
            non_finite_samples=outcome.non_finite_samples,
        )
        self._committer.add(commit, TileFile(lease.job_id, lease.file(outcome.position), outcome.size))

    async def _on_batch(self, batch: Batch) -> None:
        for commit, taken in zip(batch.commits, batch.taken, strict=True):
            run = self._runs.get(commit.job_id)
            if taken:
                self.tallies.samples += commit.samples
                self.tallies.rays += commit.rays
            if taken and run is not None:
                run.commit(commit.fence, commit.pass_index, commit.tile, commit.sha256)
        self.tallies.tiles += sum(batch.taken)
        self.tallies.stale_tiles += len(batch.taken) - sum(batch.taken)
        self.tallies.commit_seconds.add(batch.seconds)
        faults = {run.id: (run, f.reason) for f in batch.faults if (run := self._runs.of_lease(f.fence)) is not None}
        for fence in batch.ended:
            run = self._runs.of_lease(fence)
            if run is not None and (undone := run.end_lease(fence)):
                self._background(self._blobs.drop(undone))
        if faults:
            await self._disk.look()
        for run, reason in faults.values():
            if not self._disk.full:
                await self._runs.count_failure(run, FailureKind.RESOURCE, reason)
        for job_id in {commit.job_id for commit in batch.commits}:
            self.watch.notify(job_id)

    async def _on_prepared(self, run: JobRun, outcome: Prepared) -> None:
        facts, request = outcome.facts, run.request
        frame = PixelRect(0, 0, facts.width, facts.height)
        crop = request.crop or facts.crop
        if frame.area > self._settings.max_pixels:
            await self._runs.fail(
                run, f"size = {facts.width}x{facts.height}: expected at most {self._settings.max_pixels} pixels"
            )
        elif not frame.contains(crop) or crop.area == 0:
            await self._runs.fail(
                run,
                f"crop = {crop.x},{crop.y} {crop.width}x{crop.height}: expected a part of the frame, "
                f"{facts.width}x{facts.height} pixels",
            )
        else:
            facts = replace(facts, crop=crop)
            grid = TileGrid(crop, self._settings.tile_size if request.goal.rel_error is None else ERROR_TILE)
            await self._ledger.record_facts(outcome.lease.fence, run.id, facts, grid)
            reach("facts-recorded")
            run.end_lease(outcome.lease.fence)
            run.start(facts, grid, None, time.monotonic())
            self.watch.notify(run.id)

    async def _publish(self, run: JobRun, merged: Merged) -> None:
        """In its own task, since syncing a film takes time; the result comes back through the inbox."""
        try:
            running_s = run.running_s(time.monotonic())
            revision = await publish(self._ledger, self._blobs, merged, run.newest, run.film, running_s)
        except StaleLease as error:
            log.info("stale revision dropped", extra={"reason": str(error)})
        except OSError as error:
            failed = LeaseFailed(merged.lease, FailureKind.RESOURCE, f"the revision could not be stored: {error}")
            self._inbox.put(lambda: self._on_outcome(failed))
        else:
            self._inbox.put(lambda: self._on_published(run, revision))

    async def _on_published(self, run: JobRun, revision: Revision) -> None:
        run.publish(revision)
        self.tallies.revisions += 1
        self.watch.notify(run.id)

    # ---- faults ----

    async def _on_fault(self, run: JobRun, lease: Lease, kind: FailureKind | None, message: str) -> None:
        """A lease came to nothing; `kind` is None if that was not the job's fault."""
        if kind is FailureKind.RESOURCE:
            await self._disk.look()
            kind = None if self._disk.full else kind
            if self._runs.get(run.id) is None:  # it waits for room now
                await self._blobs.drop(_outputs(lease))
                return
        if kind is FailureKind.SCENE:
            await self._runs.fail(run, message)
        elif kind is None or not await self._runs.count_failure(run, kind, message):
            await self._take_back(run, lease)
            return
        await self._blobs.drop(_outputs(lease))

    async def _take_back(self, run: JobRun, lease: Lease) -> None:
        """Have the work of a lease done again."""
        if isinstance(lease, RenderLease):  # the tiles that it did finish may still be on their way to the ledger
            self._committer.end(lease.fence)
            return
        await self._ledger.commit_tiles([], [lease.fence])
        run.end_lease(lease.fence)
        if isinstance(lease, PrepareLease):
            await self._runs.change(run, JobState.QUEUED)
        await self._blobs.drop(_outputs(lease))


def _outputs(lease: Lease) -> list[Path]:
    """The scratch files that an engine process may have written for the lease."""
    if isinstance(lease, RenderLease):
        return [lease.file(position) for position in range(len(lease.tiles))]
    if isinstance(lease, MergeLease):
        return [path for path in (lease.film_out, lease.exr_out, lease.png_out) if path is not None]
    return []
