"""The unfinished jobs in memory, and how they come and go: the ledger first, memory after it."""

import logging
import time

from fluxfarm.domain.job import TERMINAL_STATES, JobState
from fluxfarm.domain.leases import FailureKind
from fluxfarm.failpoints import reach
from fluxfarm.orchestrator.dispatch import scene_ref
from fluxfarm.orchestrator.run import JobRun
from fluxfarm.orchestrator.watch import Watch
from fluxfarm.ports import BlobStore, Ledger, WorkerPool

log = logging.getLogger(__name__)

# A scene that ended this many engine processes is at fault itself.
MOST_CRASHES = 3
MOST_RESOURCE_FAILURES = 3


class Runs:
    """The orchestrator's alone: only what its inbox handles may call these."""

    def __init__(self, ledger: Ledger, blobs: BlobStore, pool: WorkerPool, watch: Watch) -> None:
        self._ledger = ledger
        self._blobs = blobs
        self._pool = pool
        self._watch = watch
        self._runs: dict[str, JobRun] = {}

    # ---- what an owner wants ----

    async def adopt_all(self) -> None:
        """Take every job into memory that should be worked on."""
        unfinished = [s for s in JobState if s not in TERMINAL_STATES and s is not JobState.PAUSED]
        for record in reversed(await self._ledger.jobs(unfinished)):
            await self.adopt(record.id)

    async def adopt(self, job_id: str) -> None:
        """Take an unfinished job into memory, resolving a state that a restart left in the middle."""
        record = await self._ledger.job(job_id)
        folder = await self._blobs.scene_folder(record.request.bundle)
        chosen = None if record.facts is None else record.facts.integrator
        run = JobRun(record, scene_ref(record.request, folder, chosen))
        if record.state is JobState.PREPARING:
            await self.change(run, JobState.QUEUED)
        elif record.state is JobState.FINALIZING:
            await self.change(run, JobState.RUNNING)
        if run.state is JobState.RUNNING:
            assert record.facts is not None and record.grid is not None
            run.start(record.facts, record.grid, await self._ledger.unmerged(job_id), time.monotonic())
        self._runs[job_id] = run
        self._watch.notify(job_id)

    async def halt(self, job_id: str, state: JobState, reason: str | None = None) -> None:
        """Stop a job by cancelling or pausing it, for a reason if it was not its owner. Again: no effect."""
        record = await self._ledger.job(job_id)
        if record.state is state:
            return
        run = self._runs.get(job_id)
        running_s = None if run is None else run.running_s(time.monotonic())
        await self._ledger.change_state(job_id, state, reason, running_s)
        self._forget(job_id)

    async def resume(self, job_id: str) -> None:
        """Let a paused job go on."""
        record = await self._ledger.job(job_id)
        await self._ledger.change_state(job_id, JobState.QUEUED if record.facts is None else JobState.RUNNING)
        await self.adopt(job_id)

    async def delete(self, job_id: str) -> None:
        """Remove a job with all of its files, cancelling it first if it is unfinished."""
        if (await self._ledger.job(job_id)).state not in TERMINAL_STATES:
            await self.halt(job_id, JobState.CANCELLED)
        await self._ledger.delete_job(job_id)
        await self._blobs.drop_job(job_id)
        self._watch.notify(job_id)

    # ---- what the work brings ----

    async def change(self, run: JobRun, state: JobState, reason: str | None = None) -> None:
        """Change a run's state in the ledger, then in memory."""
        await self._ledger.change_state(run.id, state, reason, run.running_s(time.monotonic()))
        reach(state.lower())
        run.state = state
        self._watch.notify(run.id)

    async def finish(self, run: JobRun) -> None:
        """The job has all that it will get."""
        if run.stop is not None and run.stop.warning is not None:
            await self._ledger.warn(run.id, run.stop.warning)
        await self.change(run, JobState.SUCCEEDED)
        self._forget(run.id)

    async def fail(self, run: JobRun, reason: str) -> None:
        """The job cannot be done, for a reason that its owner reads."""
        await self.change(run, JobState.FAILED, reason)
        self._forget(run.id)

    async def count_failure(self, run: JobRun, kind: FailureKind, message: str) -> bool:
        """Count a failure; returns True if it was one too many and the job failed."""
        crash = kind is FailureKind.INTERNAL
        count = await self._ledger.count_failure(run.id, crash, run.running_s(time.monotonic()))
        log.warning("work failed", extra={"job": run.id, "kind": str(kind), "count": count, "reason": message})
        if crash:
            run.crashes = count
        if count >= (MOST_CRASHES if crash else MOST_RESOURCE_FAILURES):
            times = "ended three engine processes" if crash else "ran out of resources three times"
            await self.fail(run, f"{times}: {message}")
            return True
        return False

    # ---- questions ----

    def get(self, job_id: str) -> JobRun | None:
        """The run of a job that is worked on."""
        return self._runs.get(job_id)

    def of_lease(self, fence: int) -> JobRun | None:
        """The run that a lease belongs to, while that is open."""
        return next((run for run in self._runs.values() if run.has_lease(fence)), None)

    def in_order(self) -> list[JobRun]:
        """All runs, the most urgent first."""
        return sorted(self._runs.values(), key=lambda run: (-run.request.priority, run.created_at))

    def _forget(self, job_id: str) -> None:
        """The job is not worked on any more."""
        self._runs.pop(job_id, None)
        self._pool.cancel(job_id)
        self._watch.notify(job_id)
