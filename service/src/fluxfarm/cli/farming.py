"""The bodies of `fluxfarm scheduler`, `worker` and `certificates`."""

import asyncio
import signal
from pathlib import Path
from typing import Literal

from fluxfarm import logs
from fluxfarm.errors import StartError
from fluxfarm.settings import Settings


def run_node(kind: Literal["scheduler", "worker"], settings: Settings) -> None:
    """Run until SIGINT or SIGTERM; raises StartError."""
    try:
        from fluxfarm.adapters.dask import dask_logs
        from fluxfarm.adapters.dask.nodes import run_scheduler, run_worker
    except ImportError as error:
        raise missing(error) from None
    logs.set_up(settings.log_level)
    dask_logs.send_to_ours()
    work = run_scheduler if kind == "scheduler" else run_worker

    async def run() -> None:
        task = asyncio.ensure_future(work(settings))
        for number in (signal.SIGINT, signal.SIGTERM):
            asyncio.get_running_loop().add_signal_handler(number, task.cancel)
        try:
            await task
        except asyncio.CancelledError:
            return

    asyncio.run(run())


def write_certificates(folder: Path) -> None:
    """Make certificates, and say which are new; raises StartError."""
    try:
        from fluxfarm.adapters.dask.certificates import make_certificates
    except ImportError as error:
        raise missing(error) from None
    new = make_certificates(folder)
    for path in new:
        print(path)
    if not new:
        print(f"{folder}: has certificates already")


def missing(error: ImportError) -> StartError:
    """The parts for farms are not installed."""
    return StartError(f"farms of machines need the extra fluxfarm[dask]: {error}")
