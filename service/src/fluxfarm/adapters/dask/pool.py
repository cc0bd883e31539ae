"""The WorkerPool role on many machines: workers of a Dask farm take samples, one process here prepares and merges.

The ledger stays the only truth: Dask holds only the leases that workers have in their windows, and is never asked to
try one again. A worker that has left, or a scheduler that is another one than before, loses its leases; one that cannot
be asked has an unknown fate, so its leases stand, and it gets no more.
"""

import asyncio
import hashlib
import logging
from collections.abc import AsyncIterator, Awaitable, Callable
from dataclasses import replace
from pathlib import Path
from typing import Any, TypeVar

from distributed import Client, Future

import fluxfarm
from fluxfarm.adapters.dask import worker_side
from fluxfarm.adapters.dask.messages import Greeting, Rendered
from fluxfarm.adapters.dask.security import security
from fluxfarm.adapters.engine.local_pool import LocalPool
from fluxfarm.domain.leases import (
    FailureKind,
    Lease,
    LeaseFailed,
    LeaseLost,
    Outcome,
    RenderLease,
    TileRendered,
    TilesFinished,
)
from fluxfarm.ports import WorkerInfo

T = TypeVar("T")
log = logging.getLogger(__name__)

LOOK_S = 0.5
# An answer of the scheduler or a worker that takes longer counts as none.
ANSWER_S = 5.0


class DaskPool:
    """`home` are the processes of this machine; workers of the farm at `scheduler` come and go."""

    def __init__(self, home: LocalPool, scheduler: str, certificates: Path | None) -> None:
        """Raises BadSetting."""
        self._home = home
        self._scheduler = scheduler
        self._security = security(scheduler, certificates)
        self._client: Client | None = None
        self._scheduler_id: str | None = None
        self._known = False  # whether the scheduler answers
        self._members: dict[str, _Member] = {}
        self._next_id = len(home.workers()) + 1
        self._outcomes: asyncio.Queue[Outcome | None] = asyncio.Queue()
        self._tasks: set[asyncio.Task[None]] = set()

    # ---- the role ----

    async def start(self) -> None:
        """Start the processes here and begin to look for workers; returns without waiting for them."""
        await self._home.start()
        self._background(self._hear_home())
        self._background(self._look_around())

    def workers(self) -> list[WorkerInfo]:
        """The processes here, which render nothing, and all workers of the farm."""
        here = [replace(info, renders=False) for info in self._home.workers()]
        return here + [member.info(self._known, self._build) for member in self._members.values()]

    def submit(self, worker_id: int, lease: Lease) -> None:
        """Hand `lease` to a ready process; its outcomes follow."""
        member = next((m for m in self._members.values() if m.id == worker_id), None)
        if member is None and worker_id <= len(self._home.workers()):
            self._home.submit(worker_id, lease)
        elif member is None or not isinstance(lease, RenderLease):
            self._outcomes.put_nowait(LeaseLost(lease, "the worker left the farm before it got it", blamed=False))
        else:
            member.leases[lease.fence] = lease
            self._background(self._carry_out(member, lease))

    def cancel(self, job_id: str) -> None:
        """Stop all work of a job; workers that do not stop in time replace their engine process."""
        self._home.cancel(job_id)
        for member in self._members.values():
            if fences := [lease.fence for lease in member.leases.values() if lease.job_id == job_id]:
                self._background(self._cancel_at(member, job_id, fences))

    async def outcomes(self) -> AsyncIterator[Outcome | None]:
        """What all processes report, in order; None when only `workers` changed. One consumer."""
        while True:
            yield await self._outcomes.get()

    async def close(self) -> None:
        """Leave the farm and end the processes here."""
        for task in list(self._tasks):
            task.cancel()
        await asyncio.gather(*self._tasks, return_exceptions=True)
        if self._client is not None:
            await self._client.close(timeout=ANSWER_S)  # type: ignore[no-untyped-call]
        await self._home.close()

    # ---- who is there ----

    @property
    def _build(self) -> str:
        """Of the engine here: workers with another one would give other bits."""
        return self._home.workers()[0].engine_build

    async def _look_around(self) -> None:
        while True:
            try:
                if self._client is None or self._client.status == "closed":
                    self._client = await self._connect()
                await self._look(self._client)
                self._known = True
            except Exception as error:  # of many kinds, and none may end this
                if self._known:
                    log.warning("the scheduler cannot be asked", extra={"reason": repr(error)})
                self._known = False
                self._outcomes.put_nowait(None)
            await asyncio.sleep(LOOK_S)

    async def _connect(self) -> Client:
        client: Client = await Client(  # type: ignore[no-untyped-call]
            self._scheduler,
            asynchronous=True,
            direct_to_workers=True,
            timeout=ANSWER_S,
            set_as_default=False,
            security=self._security,
        )
        return client

    async def _look(self, client: Client) -> None:
        assert client.scheduler is not None
        identity = await answered(client.scheduler.identity())
        if identity["id"] != self._scheduler_id:
            self._lose(list(self._members), "the scheduler is another one than before")
            self._scheduler_id = identity["id"]
        self._lose(
            [address for address in self._members if address not in identity["workers"]], "the worker left the farm"
        )
        addresses = list(identity["workers"])
        greetings = await asyncio.gather(*(_greeting(client, address) for address in addresses))
        changed = False
        for address, greeting in zip(addresses, greetings, strict=True):
            if greeting is not None and address not in self._members:
                self._members[address] = _Member(self._next_id, address, greeting)
                self._next_id += 1
                log.info("a worker joined", extra={"address": address, "host": greeting.host})
                changed = True
            if member := self._members.get(address):
                changed = changed or member.answers != (greeting is not None) or greeting not in (None, member.greeting)
                member.answers = greeting is not None
                member.greeting = greeting or member.greeting
        if changed or not self._known:
            self._outcomes.put_nowait(None)

    def _lose(self, addresses: list[str], why: str) -> None:
        """Forget workers; their leases go to others."""
        for address in addresses:
            member = self._members.pop(address)
            log.warning("a worker is gone", extra={"address": address, "reason": why})
            leases, member.leases = list(member.leases.values()), {}
            for lease in leases:
                self._outcomes.put_nowait(LeaseLost(lease, f"worker {member.name}: {why}", blamed=False))
            self._outcomes.put_nowait(None)

    # ---- a lease ----

    async def _carry_out(self, member: "_Member", lease: RenderLease) -> None:
        """Report what becomes of a lease, unless its worker is lost before: then that was reported."""
        try:
            rendered = await self._render(member, lease)
        except Exception as error:  # whatever Dask makes of a worker's end; the next look around knows more
            log.warning("a lease came to nothing", extra={"lease": lease.fence, "reason": repr(error)})
            rendered = Rendered(lost=(f"worker {member.name}: {error!r}", False))
        if member.leases.pop(lease.fence, None) is None:
            return
        try:
            outcomes = await self._outcomes_of(lease, rendered)
        except OSError as error:
            outcomes = [LeaseFailed(lease, FailureKind.RESOURCE, f"a tile could not be written: {error}")]
        for outcome in outcomes:
            self._outcomes.put_nowait(outcome)

    async def _render(self, member: "_Member", lease: RenderLease) -> Rendered:
        bundle = lease.scene.bundle
        for attempt in range(3):
            rendered: Rendered = await self._at(
                member, worker_side.render, lease, bundle, key=f"{lease.job_id}-{lease.fence}-{attempt}"
            )
            if not rendered.missing:
                return rendered
            for path, sha256 in bundle.files.items():
                if sha256 in rendered.missing:
                    content = await asyncio.to_thread((lease.scene.folder / path).read_bytes)
                    await self._at(member, worker_side.put, sha256, content)
        return Rendered(lost=("the worker does not keep the files of the scene", False))

    async def _at(self, member: "_Member", function: Callable[..., Any], *arguments: Any, key: str | None = None) -> T:
        """Have a function run by this worker and no other, once."""
        assert self._client is not None
        future: Future[T] = self._client.submit(
            function, *arguments, workers=[member.address], allow_other_workers=False, pure=False, retries=0, key=key
        )
        try:
            result: T = await future
            return result
        finally:
            future.release()  # type: ignore[no-untyped-call]

    async def _outcomes_of(self, lease: RenderLease, rendered: Rendered) -> list[Outcome]:
        """As if an engine process here had rendered it: the tiles in their files, then the last word."""
        found: list[Outcome] = []
        for tile in rendered.tiles:
            if hashlib.sha256(tile.content).hexdigest() != tile.sha256:
                return [LeaseFailed(lease, FailureKind.RESOURCE, "a tile came with other bytes than were sent")]
            await asyncio.to_thread(lease.file(tile.position).write_bytes, tile.content)
            figures = (len(tile.content), tile.seconds, tile.rays, tile.non_finite_samples)
            found.append(TileRendered(lease, tile.position, *figures))
        if rendered.failure is not None:
            found.append(LeaseFailed(lease, *rendered.failure))
        elif rendered.lost is not None:
            found.append(LeaseLost(lease, *rendered.lost))
        else:
            found.append(TilesFinished(lease))
        return found

    async def _cancel_at(self, member: "_Member", job_id: str, fences: list[int]) -> None:
        if self._client is not None:
            await answered(
                self._client.run(worker_side.cancel, job_id, fences, workers=[member.address], on_error="ignore")
            )

    async def _hear_home(self) -> None:
        async for outcome in self._home.outcomes():
            self._outcomes.put_nowait(outcome)

    def _background(self, work: Awaitable[None]) -> None:
        task = asyncio.ensure_future(work)
        self._tasks.add(task)
        task.add_done_callback(self._done)

    def _done(self, task: "asyncio.Task[None]") -> None:
        self._tasks.discard(task)
        if not task.cancelled() and task.exception() is not None:
            log.warning("work for a worker failed", exc_info=task.exception())


class _Member:
    """A worker of the farm as it is known here."""

    def __init__(self, number: int, address: str, greeting: Greeting) -> None:
        self.id = number
        self.address = address
        self.greeting = greeting
        self.answers = True
        self.leases: dict[int, RenderLease] = {}

    @property
    def name(self) -> str:
        """For people."""
        return f"{self.greeting.host} ({self.address})"

    def info(self, scheduler_answers: bool, build: str) -> WorkerInfo:
        """This worker as the ports see it."""
        greeting = self.greeting
        state, last_words = greeting.state, greeting.last_words
        if state in ("READY", "WORKING"):
            state = "WORKING" if self.leases else "READY"
        if not scheduler_answers or not self.answers:
            state = "UNKNOWN"
            last_words = f"{'the worker' if scheduler_answers else 'the scheduler'} does not answer"
        elif greeting.version != fluxfarm.__version__ or (build and greeting.engine_build not in ("", build)):
            other = f"Fluxfarm {greeting.version}, engine build {greeting.engine_build}"
            state = "REFUSED"
            last_words = f"{self.name}: {other}, expected {fluxfarm.__version__}, {build}; install the same on all"
        return WorkerInfo(
            id=self.id,
            state=state,
            pid=greeting.pid,
            threads=greeting.threads,
            engine_build=greeting.engine_build,
            restarts=greeting.restarts,
            leases=tuple((lease.fence, lease.job_id) for lease in self.leases.values()),
            last_words=last_words,
            sandbox_missing=greeting.sandbox_missing,
            host=greeting.host,
            prepares=False,
        )


async def _greeting(client: Client, address: str) -> Greeting | None:
    """What a worker is, or None if it does not answer."""
    try:
        found = await answered(client.run(worker_side.greet, workers=[address]))
    except Exception as error:  # of many kinds; the scheduler tells when it has left
        log.info("a worker does not answer", extra={"address": address, "reason": repr(error)})
        return None
    greeting = found.get(address)
    return greeting if isinstance(greeting, Greeting) else None


async def answered(question: Awaitable[T]) -> T:
    """The answer, or TimeoutError."""
    return await asyncio.wait_for(question, ANSWER_S)
