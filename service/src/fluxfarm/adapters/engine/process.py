"""One engine process: its socket, the requests it holds and how it ends.

The process gets one end of a socket pair and ends itself when the other end closes, so nothing is left behind even if
this service is killed.
"""

import asyncio
import itertools
import logging
import signal
import socket
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from fluxfarm.adapters.engine import codec
from fluxfarm.domain.leases import Lease, LeaseLost, MergeLease, Outcome, PrepareLease, RenderLease, SceneRef

log = logging.getLogger(__name__)

HELLO_TIMEOUT_S = 20.0
CANCEL_GRACE_S = 1.0
LAST_WORDS_BYTES = 2000


@dataclass(frozen=True, slots=True)
class EngineCommand:
    """How engine processes start: shut in to the folder `data`, with at most `memory_bytes` (0: any), and given up
    without a sign of progress for `stall_s` seconds."""

    program: Path
    threads: int
    stall_s: float
    data: Path
    memory_bytes: int
    require_sandbox: bool

    def words(self, descriptor: int) -> list[str]:
        """Its command line; `descriptor` is its end of the socket."""
        words = [str(self.program), "worker", "--fd", str(descriptor), "--threads", str(self.threads)]
        words += ["--data", str(self.data.absolute()), "--memory", str(self.memory_bytes)]
        return [*words, "--require-sandbox"] if self.require_sandbox else words


class EngineProcess:
    """A child process from its start to its end. `report` is called with each outcome, in order."""

    def __init__(self, engine: EngineCommand, report: Callable[[Outcome | None], None]) -> None:
        self._engine = engine
        self._report = report
        self._ids = itertools.count(1)
        self._held: dict[int, Lease] = {}
        self._scene_requests: dict[int, Lease] = {}
        self._loaded_key: str | None = None
        self._child: asyncio.subprocess.Process | None = None
        self._writer: asyncio.StreamWriter | None = None
        self._last_heard = time.monotonic()
        self._killed_because: tuple[str, bool] | None = None
        self._last_words = b""
        self.hello: codec.Hello | None = None

    # ---- verbs ----

    async def run(self) -> str:
        """Start the child and serve it until it is gone; returns why it ended. Its leases are reported lost."""
        ours, theirs = socket.socketpair()
        try:
            with theirs:
                self._child = await asyncio.create_subprocess_exec(
                    *self._engine.words(theirs.fileno()),
                    pass_fds=[theirs.fileno()],
                    stdin=asyncio.subprocess.DEVNULL,
                    stdout=asyncio.subprocess.PIPE,
                    stderr=asyncio.subprocess.STDOUT,
                    start_new_session=True,
                )
            reader, self._writer = await asyncio.open_connection(sock=ours)
        except BaseException:
            ours.close()
            raise
        helpers = [asyncio.ensure_future(self._listen_to_logs()), asyncio.ensure_future(self._watch_for_stalls())]
        try:
            await self._serve(reader)
        except codec.ProtocolError as error:
            self.kill(f"broke the protocol: {error}", blame=True)
        finally:
            self._writer.close()
            status = await self._reap()
            helpers[1].cancel()
            await asyncio.gather(*helpers, return_exceptions=True)
        return self._mourn(status)

    def submit(self, lease: Lease) -> None:
        """Send a lease, preceded by its scene if the process was not last told to keep that one."""
        scene = _scene_of(lease)
        if scene is not None and not isinstance(lease, PrepareLease) and scene.key != self._loaded_key:
            request_id = next(self._ids)
            self._scene_requests[request_id] = lease
            self._send(codec.load_scene(request_id, scene))
        if scene is not None:
            self._loaded_key = scene.key
        if not self._held:
            self._last_heard = time.monotonic()
        request_id = next(self._ids)
        self._held[request_id] = lease
        self._send(codec.lease(request_id, lease))

    def cancel(self, job_id: str) -> None:
        """Ask the process to drop a job's requests; it is killed if it does not in time."""
        targets = [request_id for request_id, lease in self._held.items() if lease.job_id == job_id]
        targets += [request_id for request_id, lease in self._scene_requests.items() if lease.job_id == job_id]
        for target in targets:
            self._send(codec.cancel(next(self._ids), target))
        if targets:
            asyncio.get_running_loop().call_later(CANCEL_GRACE_S, self._kill_if_holding, targets)

    def kill(self, reason: str, blame: bool) -> None:
        """End the child at once. `blame`: the lease it works on is the cause."""
        if self._child is not None and self._child.returncode is None and self._killed_because is None:
            self._killed_because = (reason, blame)
            self._child.kill()

    async def close(self) -> None:
        """End the child by closing its socket; kill it if that does not do."""
        self._killed_because = self._killed_because or ("the service ends", False)
        if self._writer is not None:
            self._writer.close()
        await self._reap()

    # ---- questions ----

    @property
    def pid(self) -> int | None:
        """Process id, None before the start."""
        return None if self._child is None else self._child.pid

    @property
    def leases(self) -> list[Lease]:
        """The leases it holds, oldest first."""
        return list(self._held.values())

    @property
    def last_words(self) -> str:
        """The last lines it wrote to its log."""
        return "\n".join(self._last_words.decode(errors="replace").splitlines()[-8:])

    # ---- inside ----

    async def _serve(self, reader: asyncio.StreamReader) -> None:
        """Read frames until the socket closes."""
        try:
            frame = await asyncio.wait_for(_read_frame(reader), HELLO_TIMEOUT_S)
        except TimeoutError:
            raise codec.ProtocolError(f"no Hello within {HELLO_TIMEOUT_S:g} s") from None
        while frame is not None:
            self._last_heard = time.monotonic()
            reply = codec.decode(frame)
            if self.hello is None:
                self.hello = codec.hello(reply)
                self._report(None)
            else:
                self._take(reply)
            frame = await _read_frame(reader)

    def _take(self, reply: codec.Reply) -> None:
        """Turn one reply into an outcome; replies to requests that ended already are dropped."""
        waiting = self._scene_requests.get(reply.request_id)
        if waiting is not None:
            failure = codec.failure_of(reply, waiting)
            if failure is None and not codec.is_scene_loaded(reply):
                return
            del self._scene_requests[reply.request_id]
            if failure is not None:
                self._loaded_key = None
                self._held = {key: lease for key, lease in self._held.items() if lease is not waiting}
                self._report(failure)
            return
        lease = self._held.get(reply.request_id)
        if lease is None or (codec.is_progress(reply) and not isinstance(lease, RenderLease)):
            return
        outcome, last = codec.outcome(lease, reply)
        if last:
            del self._held[reply.request_id]
            if isinstance(lease, PrepareLease) and codec.failure_of(reply, lease) is not None:
                self._loaded_key = None
        self._report(outcome)

    def _send(self, frame: bytes) -> None:
        if self._writer is not None and not self._writer.is_closing():
            self._writer.write(frame)

    def _kill_if_holding(self, targets: list[int]) -> None:
        if any(target in self._held or target in self._scene_requests for target in targets):
            self.kill("did not stop when its job was cancelled", blame=False)

    async def _watch_for_stalls(self) -> None:
        while True:
            await asyncio.sleep(min(1.0, self._engine.stall_s / 4))
            if self._held and time.monotonic() - self._last_heard > self._engine.stall_s:
                self.kill(f"gave no sign of progress for {self._engine.stall_s:g} s", blame=True)

    async def _listen_to_logs(self) -> None:
        assert self._child is not None and self._child.stdout is not None
        while text := await self._child.stdout.read(4096):
            self._last_words = (self._last_words + text)[-LAST_WORDS_BYTES:]
            log.info("engine log", extra={"pid": self._child.pid, "text": text.decode(errors="replace").rstrip()})

    async def _reap(self) -> int:
        """Wait until the child is gone, with force after a second; returns its status (negative: a signal)."""
        assert self._child is not None
        try:
            return await asyncio.wait_for(self._child.wait(), 1.0)
        except TimeoutError:
            self._child.kill()
            return await self._child.wait()

    def _mourn(self, status: int) -> str:
        """Say why the child ended and report its leases lost; the oldest one is blamed unless we ended the child."""
        if self._killed_because is not None:
            how, blame = self._killed_because
        else:
            how, blame = _ending(status), True
        reason = f"engine process {self.pid} {how}"
        if self.last_words:
            reason += f"; its last words: {self.last_words}"
        lost, self._held = list(self._held.values()), {}
        self._scene_requests = {}
        for position, lease in enumerate(lost):
            self._report(LeaseLost(lease, reason, blamed=blame and position == 0))
        return reason


def _scene_of(lease: Lease) -> SceneRef | None:
    """The scene that a process must keep to carry out the lease."""
    if isinstance(lease, PrepareLease | RenderLease):
        return lease.scene
    if isinstance(lease, MergeLease) and lease.decision is not None:
        return lease.decision.scene
    return None


async def _read_frame(reader: asyncio.StreamReader) -> bytes | None:
    """The next frame without its length; None at the end of the stream, even in the middle of a frame."""
    try:
        (length,) = codec.LENGTH.unpack(await reader.readexactly(codec.LENGTH.size))
        if length > codec.MAX_FRAME_BYTES:
            raise codec.ProtocolError(f"a frame of {length} bytes, expected at most {codec.MAX_FRAME_BYTES}")
        return await reader.readexactly(length)
    except (asyncio.IncompleteReadError, ConnectionError):
        return None


def _ending(status: int) -> str:
    """How a child with this status ended, in words."""
    if status >= 0:
        return f"ended by itself with status {status}"
    try:
        return f"was ended by signal {signal.Signals(-status).name}"
    except ValueError:
        return f"was ended by signal {-status}"
