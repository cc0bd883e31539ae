"""Jobs wait while the disk is nearly full, and go on by themselves when there is room again.

Before it is full: the ledger itself needs room to say that a job waits.
"""

import logging

from fluxfarm.domain.job import TRANSITIONS, JobState
from fluxfarm.orchestrator.runs import Runs
from fluxfarm.ports import BlobStore, Ledger

log = logging.getLogger(__name__)

REASON = "the disk is nearly full"
# Room to go on, over that below which jobs wait.
ROOM_AGAIN = 2


class DiskGuard:
    """Looks when it is asked to; only what the inbox handles may ask."""

    def __init__(self, ledger: Ledger, blobs: BlobStore, runs: Runs, least_free_bytes: int) -> None:
        self._ledger = ledger
        self._blobs = blobs
        self._runs = runs
        self._least = least_free_bytes
        # Also of a service before this one, whose jobs may go on now.
        self.full = True

    async def look(self) -> None:
        """Pause all jobs, or resume those that wait for room."""
        free = self._blobs.free_bytes()
        if free < self._least:
            self.full = True
            await self._pause_all(free)
        elif self.full and free >= ROOM_AGAIN * self._least:
            self.full = False
            await self._resume_all()

    async def _pause_all(self, free: int) -> None:
        reason = (
            f"{REASON}: {free} bytes free in the data folder, expected at least {self._least}; "
            "the job goes on by itself when there is room"
        )
        for run in self._runs.in_order():
            if JobState.PAUSED in TRANSITIONS[run.state]:
                log.error("job waits for room on the disk", extra={"job": run.id, "free_bytes": free})
                await self._runs.halt(run.id, JobState.PAUSED, reason)

    async def _resume_all(self) -> None:
        for record in reversed(await self._ledger.jobs([JobState.PAUSED])):
            if record.reason is not None and record.reason.startswith(REASON):
                log.info("job goes on, there is room on the disk", extra={"job": record.id})
                await self._runs.resume(record.id)
