"""Takes rendered tiles to disk and into the ledger, many at a time.

The order for each tile is: its scratch file synced and moved to its digest, then one transaction guarded by the
lease's fence, then the news. A batch waits a moment for company, unless a lease has ended: one transaction for many
tiles costs little more than one for a single tile.
"""

import asyncio
import logging
import time
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, replace

from fluxfarm.domain.records import TileCommit, TileFile
from fluxfarm.failpoints import reach
from fluxfarm.ports import BlobStore, Ledger

log = logging.getLogger(__name__)

MOST_TILES_IN_A_BATCH = 256
MOST_BYTES_IN_A_BATCH = 64 << 20
# How long a finished tile waits for others.
GATHER_S = 0.5

# A tile and its file, or the fence of a lease that ended.
Entry = tuple[TileCommit, TileFile] | int


@dataclass(frozen=True, slots=True)
class Fault:
    """Why tiles of the lease `fence` were not stored."""

    fence: int
    reason: str


@dataclass(frozen=True, slots=True)
class Batch:
    """What became of one batch: the stored tiles with their digests, which of them were taken, and the leases ended
    after it. `faults` has one entry for each lease that had a bad file; for all of them, with nothing taken, when the
    disk or the ledger refused."""

    commits: tuple[TileCommit, ...]
    taken: tuple[bool, ...]
    ended: tuple[int, ...]
    seconds: float
    faults: tuple[Fault, ...]


class Committer:
    """Runs as one task; `report` is called with each finished batch."""

    def __init__(self, ledger: Ledger, blobs: BlobStore, report: Callable[[Batch], None]) -> None:
        self._ledger = ledger
        self._blobs = blobs
        self._report = report
        self._waiting: list[Entry] = []
        self._wake = asyncio.Event()
        self._due = asyncio.Event()
        self.backlog_bytes = 0

    def add(self, commit: TileCommit, file: TileFile) -> None:
        """Have a tile committed; its digest is filled in on the way."""
        self.backlog_bytes += file.size
        self._waiting.append((commit, file))
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

    def _take_batch(self) -> list[Entry]:
        count, size = 0, 0
        while count < min(len(self._waiting), MOST_TILES_IN_A_BATCH) and size < MOST_BYTES_IN_A_BATCH:
            entry = self._waiting[count]
            size += 0 if isinstance(entry, int) else entry[1].size
            count += 1
        batch, self._waiting = self._waiting[:count], self._waiting[count:]
        return batch

    async def _commit(self, batch: list[Entry]) -> None:
        started = time.monotonic()
        tiles = [entry for entry in batch if not isinstance(entry, int)]
        ended = tuple(entry for entry in batch if isinstance(entry, int))
        stored: list[TileCommit] = []
        faults: dict[int, Fault] = {}
        try:
            adopted = await self._blobs.adopt_tiles([file for _, file in tiles]) if tiles else []
            for (commit, _), digest in zip(tiles, adopted, strict=True):
                if isinstance(digest, str):
                    stored.append(replace(commit, sha256=digest))
                else:
                    faults[commit.fence] = Fault(commit.fence, f"a tile could not be stored: {digest}")
            if stored:
                reach("tiles-stored")
            taken = await self._ledger.commit_tiles(stored, ended)
            if stored:
                reach("tiles-committed")
        except Exception as error:
            log.exception("tiles could not be committed")
            taken = [False] * len(stored)
            faults = {c.fence: Fault(c.fence, f"tiles could not be stored: {error}") for c, _ in tiles}
        self.backlog_bytes -= sum(file.size for _, file in tiles)
        self._report(Batch(tuple(stored), tuple(taken), ended, time.monotonic() - started, tuple(faults.values())))
