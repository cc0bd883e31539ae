"""The data folder as a whole: held by one service at a time, swept when it starts."""

import fcntl
import os
import shutil
import time
from collections.abc import Iterable
from pathlib import Path
from typing import IO

from fluxfarm.errors import DataFolderInUse, StoreDamaged


def hold(root: Path) -> IO[str]:
    """Take the folder for this process until the returned file is closed; raises DataFolderInUse."""
    root.mkdir(parents=True, exist_ok=True)
    file = (root / "lock").open("a+")
    try:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError:
        file.seek(0)
        holder = file.read().strip() or "unknown"
        file.close()
        raise DataFolderInUse(
            f"data folder {root}: held by another service (process {holder}); "
            "stop it or set FLUXFARM_DATA to another folder"
        ) from None
    file.truncate(0)
    file.write(f"{os.getpid()}\n")
    file.flush()
    return file


def write_secret(path: Path, secret: str) -> None:
    """Write a file that only this user can read, over an older one."""
    temporary = path.with_name(f".{path.name}.part")
    temporary.unlink(missing_ok=True)
    temporary.touch(0o600, exist_ok=False)
    with temporary.open("w") as file:
        file.write(secret + "\n")
        file.flush()
        os.fsync(file.fileno())
    temporary.replace(path)


def sweep(root: Path, named: dict[str, set[str]], kept_assets: Iterable[str], keep_assets_s: float) -> int:
    """Remove what nothing refers to; returns how many files went.

    `named` maps each job to the digests of its tiles and outputs, `kept_assets` are the files of all bundles. An
    unreferenced asset stays for `keep_assets_s` seconds, since its job may still be on its way. Raises StoreDamaged if
    the ledger names a file that is not there.
    """
    for name in ("incoming", "scenes"):
        shutil.rmtree(root / name, ignore_errors=True)
        (root / name).mkdir(parents=True, exist_ok=True)
    removed = _sweep_assets(root / "assets", set(kept_assets), time.time() - keep_assets_s)
    for folder in (root / "jobs").iterdir():
        if folder.name not in named:
            shutil.rmtree(folder, ignore_errors=True)
            removed += 1
            continue
        shutil.rmtree(folder / "scratch", ignore_errors=True)
        for kind in ("tiles", "outputs"):
            if (folder / kind).is_dir():
                for path in (folder / kind).iterdir():
                    if path.name not in named[folder.name]:
                        path.unlink()
                        removed += 1
    for job_id, digests in named.items():
        for sha256 in digests:
            if not any((root / "jobs" / job_id / kind / sha256).is_file() for kind in ("tiles", "outputs")):
                raise StoreDamaged(
                    f"job {job_id}: the ledger names the file {sha256}, which is not in {root / 'jobs' / job_id}; "
                    "restore the data folder from a backup"
                )
    return removed


def _sweep_assets(folder: Path, kept: set[str], before: float) -> int:
    """Remove unreferenced assets last changed before the Unix time `before`."""
    old = [path for path in folder.iterdir() if path.name not in kept and path.stat().st_mtime < before]
    for path in old:
        path.unlink()
    return len(old)
