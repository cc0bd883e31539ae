"""Takes rendered tiles to disk and into the ledger, many at a time.

The order for each tile is: bytes synced under their digest, then one transaction guarded by the lease's fence, then
the news. A batch waits a moment for company, unless a lease has ended: one transaction for many tiles costs little more
than one for a single tile.
"""

import asyncio
import logging
import time
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, replace

from fluxfarm.domain.records import TileCommit
from fluxfarm.ports import BlobStore, Ledger

log = logging.getLogger(__name__)

MOST_TILES_IN_A_BATCH = 256
MOST_BYTES_IN_A_BATCH = 64 << 20
# How long a finished tile waits for others.
GATHER_S = 0.5


@dataclass(frozen=True, slots=True)
class Batch:
    """What became of one batch: the tiles with their digests, which of them were taken, and the leases ended after it.

    `fault` is set, and nothing was taken, when the disk or the ledger refused."""

    commits: tuple[TileCommit, ...]
    taken: tuple[bool, ...]
    ended: tuple[int, ...]
    seconds: float
    fault: str | None = None


class Committer:
    """Runs as one task; `report` is called with each finished batch."""

    def __init__(self, ledger: Ledger, blobs: BlobStore, report: Callable[[Batch], None]) -> None:
        self._ledger = ledger
        self._blobs = blobs
        self._report = report
        self._waiting: list[tuple[TileCommit, bytes] | int] = []
        self._wake = asyncio.Event()
        self._due = asyncio.Event()
        self.backlog_bytes = 0

    def add(self, commit: TileCommit, sums: bytes) -> None:
        """Have a tile committed; its digest is filled in on the way."""
        self.backlog_bytes += len(sums)
        self._waiting.append((commit, sums))
        self._wake.set()
        if self.backlog_bytes >= MOST_BYTES_IN_A_BATCH or len(self._waiting) >= MOST_TILES_IN_A_BATCH:
            self._due.set()

    def end(self, fence: int) -> None:
        """Have a lease ended after all of its tiles that were added before."""
        self._waiting.append(fence)
        self._wake.set()
        self._due.set()

    async def run(self) -> None:
        """Commit batches until cancelled."""
        while True:
            await self._wake.wait()
            with suppress(TimeoutError):
                await asyncio.wait_for(self._due.wait(), GATHER_S)
            self._wake.clear()
            self._due.clear()
            while self._waiting:
                await self._commit(self._take_batch())

    def _take_batch(self) -> list[tuple[TileCommit, bytes] | int]:
        count, size = 0, 0
        while count < min(len(self._waiting), MOST_TILES_IN_A_BATCH) and size < MOST_BYTES_IN_A_BATCH:
            entry = self._waiting[count]
            size += 0 if isinstance(entry, int) else len(entry[1])
            count += 1
        batch, self._waiting = self._waiting[:count], self._waiting[count:]
        return batch

    async def _commit(self, batch: list[tuple[TileCommit, bytes] | int]) -> None:
        started = time.monotonic()
        tiles = [entry for entry in batch if not isinstance(entry, int)]
        ended = tuple(entry for entry in batch if isinstance(entry, int))
        commits = tuple(commit for commit, _ in tiles)
        taken: tuple[bool, ...] = (False,) * len(tiles)
        fault = None
        try:
            if tiles:
                digests = await self._blobs.put_tiles([(commit.job_id, sums) for commit, sums in tiles])
                commits = tuple(replace(c, sha256=sha256) for c, sha256 in zip(commits, digests, strict=True))
            taken = tuple(await self._ledger.commit_tiles(commits, ended))
        except Exception as error:
            log.exception("tiles could not be committed")
            fault = f"tiles could not be stored: {error}"
        self.backlog_bytes -= sum(len(sums) for _, sums in tiles)
        self._report(Batch(commits, taken, ended, time.monotonic() - started, fault))
