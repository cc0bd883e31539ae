"""Checks that a service could run here, one line each."""

import json
import os
import shutil
import sqlite3
import subprocess
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

from fluxfarm.adapters.engine.codec import PROTOCOL_VERSION
from fluxfarm.adapters.ledger.database import sqlite_warning
from fluxfarm.errors import FarmError
from fluxfarm.settings import Settings, engine_program, scenes_folder

LEAST_FREE_BYTES = 1 << 30


@dataclass(frozen=True, slots=True)
class Finding:
    """One check: `ok` is None for a warning."""

    name: str
    ok: bool | None
    text: str


def examine(settings: Settings) -> Iterator[Finding]:
    """All checks, in the order in which to mend what is wrong."""
    checks: tuple[Callable[[Settings], Finding], ...] = (_engine, _data_folder, _sqlite, _disk, _scenes)
    for check in checks:
        try:
            yield check(settings)
        except FarmError as error:
            yield Finding(check.__name__.strip("_").replace("_", " "), False, str(error))


def _engine(settings: Settings) -> Finding:
    program = engine_program(settings)
    try:
        ran = subprocess.run([program, "info", "--json"], capture_output=True, text=True, timeout=20, check=False)
    except (OSError, subprocess.TimeoutExpired) as error:
        return Finding("engine", False, f"{program}: does not run: {error}")
    if ran.returncode != 0:
        return Finding("engine", False, f"{program} info --json: status {ran.returncode}: {ran.stderr.strip()[:500]}")
    try:
        info = json.loads(ran.stdout)
    except ValueError:
        return Finding("engine", False, f"{program} info --json: printed no JSON: {ran.stdout[:200]!r}")
    spoken = info.get("protocol_version", PROTOCOL_VERSION)
    if spoken != PROTOCOL_VERSION:
        return Finding("engine", False, f"{program}: protocol {spoken}, expected {PROTOCOL_VERSION}: build both anew")
    return Finding("engine", True, f"{program}, build {info.get('build') or info.get('engine_build') or 'unknown'}")


def _data_folder(settings: Settings) -> Finding:
    folder = settings.data
    probe = folder / f".doctor-{os.getpid()}"
    try:
        folder.mkdir(parents=True, exist_ok=True)
        probe.write_bytes(b"")
        probe.unlink()
    except OSError as error:
        return Finding("data folder", False, f"{folder}: cannot be written: {error.strerror}; set FLUXFARM_DATA")
    return Finding("data folder", True, str(folder))


def _sqlite(settings: Settings) -> Finding:
    warning = sqlite_warning()
    if warning is not None:
        return Finding("SQLite", None, warning)
    return Finding("SQLite", True, sqlite3.sqlite_version)


def _disk(settings: Settings) -> Finding:
    folder = next(parent for parent in (settings.data, *settings.data.parents) if parent.exists())
    free = shutil.disk_usage(folder).free
    text = f"{free / 2**30:.1f} GiB free"
    return Finding("disk", True if free >= LEAST_FREE_BYTES else None, text)


def _scenes(settings: Settings) -> Finding:
    folder: Path | None = scenes_folder(settings)
    names = [] if folder is None else sorted(path.parent.name for path in folder.glob("*/scene.xml"))
    if not names:
        return Finding("built-in scenes", None, "none found; set FLUXFARM_SCENES to the repository's folder scenes/")
    return Finding("built-in scenes", True, ", ".join(names))
