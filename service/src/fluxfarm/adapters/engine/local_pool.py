"""The WorkerPool role on this machine: a fixed number of engine processes, each replaced when it dies."""

import asyncio
import logging
import time
from collections.abc import AsyncIterator

from fluxfarm.adapters.engine.process import EngineCommand, EngineProcess
from fluxfarm.domain.leases import Lease, LeaseLost, Outcome
from fluxfarm.ports import WorkerInfo

log = logging.getLogger(__name__)

FIRST_PAUSE_S = 0.05
LONGEST_PAUSE_S = 5.0
# A process that lived this long was no failed start.
GOOD_LIFE_S = 5.0


class LocalPool:
    """`workers` processes of one engine."""

    def __init__(self, engine: EngineCommand, workers: int) -> None:
        self._engine = engine
        self._slots = [_Slot(number) for number in range(1, workers + 1)]
        self._outcomes: asyncio.Queue[Outcome | None] = asyncio.Queue()
        self._tasks: list[asyncio.Task[None]] = []

    async def start(self) -> None:
        """Start the processes; returns without waiting for them to be ready."""
        self._tasks = [asyncio.create_task(self._keep_alive(slot)) for slot in self._slots]

    def submit(self, worker_id: int, lease: Lease) -> None:
        """Hand `lease` to a ready process; its outcomes follow."""
        process = self._slots[worker_id - 1].process
        if process is None:
            self._outcomes.put_nowait(LeaseLost(lease, "the engine process ended before it got it", blamed=False))
        else:
            process.submit(lease)

    def cancel(self, job_id: str) -> None:
        """Stop all work of a job; a process that does not stop in time is replaced."""
        for slot in self._slots:
            if slot.process is not None:
                slot.process.cancel(job_id)

    async def outcomes(self) -> AsyncIterator[Outcome | None]:
        """What the processes report, in order; None when only `workers` changed. One consumer."""
        while True:
            yield await self._outcomes.get()

    async def close(self) -> None:
        """End all processes and wait until they are gone."""
        processes = [slot.process for slot in self._slots if slot.process is not None and slot.process.pid is not None]
        for slot in self._slots:
            slot.closing = True
        await asyncio.gather(*(process.close() for process in processes))
        for task in self._tasks:
            task.cancel()
        await asyncio.gather(*self._tasks, return_exceptions=True)

    def workers(self) -> list[WorkerInfo]:
        """All processes as they are now."""
        return [slot.info(self._engine.threads) for slot in self._slots]

    async def _keep_alive(self, slot: "_Slot") -> None:
        pause_s = FIRST_PAUSE_S
        while not slot.closing:
            started = time.monotonic()
            process = EngineProcess(self._engine, self._outcomes.put_nowait)
            slot.process = process
            try:
                reason = await process.run()
            except OSError as error:
                reason = f"{self._engine.program}: cannot be started: {error}"
            slot.process = None
            if slot.closing:
                return
            slot.restarts += 1
            slot.last_words = reason
            log.warning("engine process replaced", extra={"worker": slot.number, "reason": reason})
            self._outcomes.put_nowait(None)
            good = process.hello is not None or time.monotonic() - started > GOOD_LIFE_S
            slot.failed_starts = 0 if good else slot.failed_starts + 1
            pause_s = FIRST_PAUSE_S if good else min(2 * pause_s, LONGEST_PAUSE_S)
            await asyncio.sleep(pause_s)


class _Slot:
    """The place of one process and of those that replace it."""

    def __init__(self, number: int) -> None:
        self.number = number
        self.process: EngineProcess | None = None
        self.restarts = 0
        self.failed_starts = 0
        self.last_words = ""
        self.closing = False

    def info(self, threads: int) -> WorkerInfo:
        """This place as the ports see it."""
        process = self.process
        hello = None if process is None else process.hello
        leases = [] if process is None else process.leases
        if hello is None:
            state = "BROKEN" if self.failed_starts >= 3 else "STARTING"
        else:
            state = "WORKING" if leases else "READY"
        return WorkerInfo(
            id=self.number,
            state=state,
            pid=None if process is None else process.pid,
            threads=threads if hello is None else hello.threads,
            engine_build="" if hello is None else hello.engine_build,
            restarts=self.restarts,
            leases=tuple((lease.fence, lease.job_id) for lease in leases),
            last_words=self.last_words,
            sandbox_missing=() if hello is None else hello.sandbox_missing,
        )
