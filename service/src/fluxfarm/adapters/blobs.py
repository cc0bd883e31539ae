"""Files by digest in the data folder.

    lock              held by the one service that works here
    ledger.sqlite3    the ledger
    incoming/         uploads on their way; swept at start
    assets/SHA256     uploaded scene files, shared by all jobs
    scenes/DIGEST/    a bundle laid out under its own paths (links to assets); made anew after each start
    jobs/ID/tiles/    tile sums that no film contains yet
    jobs/ID/outputs/  images, previews and the newest film
    jobs/ID/scratch/  where engine processes write; swept at start

A file gets its final name only after its bytes are synced, and the folder is synced before anybody is told.
"""

import asyncio
import errno
import hashlib
import os
import shutil
import uuid
from collections.abc import AsyncIterable, Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from pathlib import Path
from typing import TypeVar

from fluxfarm.domain.records import TileFile
from fluxfarm.domain.scene import SceneBundle
from fluxfarm.errors import DigestMismatch, DiskFull, TooLarge
from fluxfarm.failpoints import reach

T = TypeVar("T")
BUFFER_BYTES = 1 << 20
SYNC_THREADS = 16
BUILTIN_ENTRY = "scene.xml"


class FileBlobStore:
    """The blob store in the folder `root`; uploads are at most `max_asset_bytes` long, and leave `least_free_bytes`.

    If not `durable`, nothing is synced: a crash of the machine may damage it, one of the service may not."""

    def __init__(self, root: Path, max_asset_bytes: int, durable: bool = True, least_free_bytes: int = 0) -> None:
        self._root = root
        self._least_free_bytes = least_free_bytes
        self._max_asset_bytes = max_asset_bytes
        self._durable = durable
        self._work = ThreadPoolExecutor(4, thread_name_prefix="blobs")
        self._sync = ThreadPoolExecutor(SYNC_THREADS, thread_name_prefix="sync")
        for name in ("incoming", "assets", "scenes", "jobs"):
            (root / name).mkdir(parents=True, exist_ok=True)

    def close(self) -> None:
        """Wait for what is being written."""
        self._work.shutdown()
        self._sync.shutdown()

    # ---- uploads and bundles ----

    async def put_asset(self, sha256: str, chunks: AsyncIterable[bytes]) -> bool:
        """Store an upload; True if it is new. Raises DigestMismatch, TooLarge or DiskFull."""
        if (free := self.free_bytes()) < self._least_free_bytes:
            raise DiskFull(
                f"asset {sha256}: {free} bytes free in the data folder, expected at least {self._least_free_bytes}"
            )
        temporary = self._root / "incoming" / uuid.uuid4().hex
        hasher, size, buffer = hashlib.sha256(), 0, bytearray()
        file = await self._in_thread(lambda: temporary.open("wb", buffering=0))

        def flush() -> None:
            hasher.update(buffer)
            file.write(buffer)
            buffer.clear()

        try:
            async for chunk in chunks:
                size += len(chunk)
                if size > self._max_asset_bytes:
                    raise TooLarge(f"asset {sha256}: longer than {self._max_asset_bytes} bytes, the most that is taken")
                buffer += chunk
                if len(buffer) >= BUFFER_BYTES:
                    await self._in_thread(flush)
            await self._in_thread(flush)
            if hasher.hexdigest() != sha256:
                raise DigestMismatch("sha256", sha256, f"the {size} bytes sent have the digest {hasher.hexdigest()}")
            return await self._in_thread(lambda: self._keep_asset(temporary, sha256))
        except OSError as error:
            if error.errno not in (errno.ENOSPC, errno.EDQUOT):
                raise
            raise DiskFull(f"asset {sha256}: no room for it in the data folder: {error.strerror}") from None
        finally:
            file.close()
            temporary.unlink(missing_ok=True)

    def free_bytes(self) -> int:
        """Room on the disk."""
        return shutil.disk_usage(self._root).free

    def missing_assets(self, digests: Sequence[str]) -> list[str]:
        """Those of `digests` that are not stored, in order, each once."""
        return [sha256 for sha256 in dict.fromkeys(digests) if not (self._root / "assets" / sha256).is_file()]

    async def put_builtin(self, folder: Path) -> SceneBundle:
        """Store the files of a scene folder whose entry is scene.xml; notes (*.md) are left out."""

        def copy() -> SceneBundle:
            files: dict[str, str] = {}
            for source in sorted(path for path in folder.rglob("*") if path.is_file() and path.suffix != ".md"):
                temporary = self._root / "incoming" / uuid.uuid4().hex
                shutil.copyfile(source, temporary)
                sha256 = file_digest(temporary)
                self._keep_asset(temporary, sha256)
                temporary.unlink(missing_ok=True)
                files[source.relative_to(folder).as_posix()] = sha256
            return SceneBundle(BUILTIN_ENTRY, files)

        return await self._in_thread(copy)

    async def scene_folder(self, bundle: SceneBundle) -> Path:
        """A folder that holds the bundle's files under their own paths."""
        return await self._in_thread(lambda: self._lay_out(bundle))

    # ---- what jobs make ----

    async def adopt_tiles(self, tiles: Sequence[TileFile]) -> list[str | OSError]:
        """Sync scratch files, many at once, and move them to their digests; returns these in order, or why a file
        was dropped."""

        def move() -> list[str | OSError]:
            adopted = list(self._sync.map(self._adopt_tile, tiles))
            jobs = {tile.job_id for tile, taken in zip(tiles, adopted, strict=True) if isinstance(taken, str)}
            faults = {job_id: fault for job_id in jobs if (fault := self._sync_tiles(job_id)) is not None}
            return [faults.get(tile.job_id, taken) for tile, taken in zip(tiles, adopted, strict=True)]

        return await self._in_thread(move)

    def tile(self, job_id: str, sha256: str) -> Path:
        """Path of a stored tile."""
        return self._job_folder(job_id, "tiles") / sha256

    def scratch(self, job_id: str, name: str) -> Path:
        """A path where an engine process may write; swept at the next start."""
        folder = self._job_folder(job_id, "scratch")
        folder.mkdir(parents=True, exist_ok=True)
        return folder / name

    async def adopt(self, job_id: str, scratch: Path) -> tuple[str, int]:
        """Sync a scratch file and move it to its digest; returns the digest and the size in bytes."""

        def move() -> tuple[str, int]:
            self._sync_path(scratch)
            sha256, size = file_digest(scratch), scratch.stat().st_size
            folder = self._job_folder(job_id, "outputs")
            self._make_folder(folder)
            reach("output-synced")
            scratch.replace(folder / sha256)
            self._sync_path(folder)
            reach("output-kept")
            return sha256, size

        return await self._in_thread(move)

    def output(self, job_id: str, sha256: str) -> Path:
        """Path of an adopted file."""
        return self._job_folder(job_id, "outputs") / sha256

    async def drop(self, paths: Sequence[Path]) -> None:
        """Remove files that nothing refers to any more."""

        def remove() -> None:
            for path in paths:
                path.unlink(missing_ok=True)

        await self._in_thread(remove)

    async def drop_job(self, job_id: str) -> None:
        """Remove all files of a job."""
        await self._in_thread(lambda: shutil.rmtree(self._root / "jobs" / job_id, ignore_errors=True))

    # ---- inside ----

    def _job_folder(self, job_id: str, kind: str) -> Path:
        return self._root / "jobs" / job_id / kind

    def _keep_asset(self, temporary: Path, sha256: str) -> bool:
        final = self._root / "assets" / sha256
        if final.is_file():
            return False
        temporary.chmod(0o444)
        self._sync_path(temporary)
        reach("asset-synced")
        temporary.replace(final)
        self._sync_path(final.parent)
        reach("asset-kept")
        return True

    def _lay_out(self, bundle: SceneBundle) -> Path:
        final = self._root / "scenes" / bundle.digest()
        if final.is_dir():
            return final
        temporary = self._root / "incoming" / uuid.uuid4().hex
        for path, sha256 in bundle.files.items():
            target = temporary / path
            target.parent.mkdir(parents=True, exist_ok=True)
            asset = self._root / "assets" / sha256
            try:
                target.hardlink_to(asset)
            except OSError:  # a file system without hard links, or too many of them
                shutil.copyfile(asset, target)
        try:
            temporary.rename(final)
        except OSError:  # made meanwhile for another job
            shutil.rmtree(temporary)
        return final

    def _adopt_tile(self, tile: TileFile) -> str | OSError:
        """Sync a scratch file and move it to its digest, or drop it; the folder is left to sync."""
        try:
            return self._move_tile(tile)
        except OSError as error:
            with suppress(OSError):
                tile.path.unlink(missing_ok=True)
            return error

    def _move_tile(self, tile: TileFile) -> str:
        with tile.path.open("rb", buffering=0) as file:
            if (size := os.fstat(file.fileno()).st_size) != tile.size:
                raise OSError(f"{tile.path}: {size} bytes, but the engine process wrote {tile.size}")
            if self._durable:
                os.fsync(file.fileno())
            sha256 = hashlib.file_digest(file, "sha256").hexdigest()
        final = self.tile(tile.job_id, sha256)
        self._make_folder(final.parent)
        reach("tile-synced")
        tile.path.replace(final)
        reach("tile-renamed")
        return sha256

    def _sync_tiles(self, job_id: str) -> OSError | None:
        """Sync the folder of a job's tiles; returns why it could not be done."""
        try:
            self._sync_path(self._job_folder(job_id, "tiles"))
        except OSError as error:
            return error
        return None

    def _make_folder(self, folder: Path) -> None:
        """Make a folder (and its parent) such that it survives a crash of the machine."""
        if not folder.is_dir():
            folder.mkdir(parents=True, exist_ok=True)
            self._sync_path(folder.parent)
            self._sync_path(folder.parent.parent)

    def _sync_path(self, path: Path) -> None:
        """Return when the file or folder is on disk."""
        if not self._durable:
            return
        descriptor = os.open(path, os.O_RDONLY)
        try:
            os.fsync(descriptor)
        finally:
            os.close(descriptor)

    async def _in_thread(self, work: Callable[[], T]) -> T:
        return await asyncio.get_running_loop().run_in_executor(self._work, work)


def file_digest(path: Path) -> str:
    """SHA-256 of a file's bytes, in hexadecimal."""
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()
