"""The processes of a farm beside the service: its scheduler, and workers that come, go and come back."""

import asyncio
import logging
from contextlib import suppress

import dask
from distributed import Scheduler, Worker
from distributed.security import Security

from fluxfarm.adapters import data_folder
from fluxfarm.adapters.dask import worker_side
from fluxfarm.adapters.dask.security import security
from fluxfarm.adapters.engine.process import EngineCommand
from fluxfarm.settings import Settings, engine_program

log = logging.getLogger(__name__)
# A worker that is not heard for so long has left; its leases go to others.
WORKER_TTL = "15s"
RETRY_S = 2.0
# Leases that a worker holds: one is rendered while the next waits.
WINDOW = 2


async def run_scheduler(settings: Settings) -> None:
    """Run a scheduler on the address of the settings until cancelled; prints its address. Raises BadSetting."""
    wanted = security(settings.scheduler, settings.certificates_folder)
    dask.config.set({"distributed.scheduler.worker-ttl": WORKER_TTL, "distributed.scheduler.allowed-failures": 0})
    async with Scheduler(host=settings.scheduler, dashboard=False, security=wanted) as scheduler:
        print(f"Fluxfarm scheduler listens on {scheduler.address}", flush=True)
        await scheduler.finished()


async def run_worker(settings: Settings) -> None:
    """Render for the farm until cancelled; joins again whenever the scheduler was away.

    Raises BadSetting, and DataFolderInUse where another worker or a service works in the same folder."""
    wanted = security(settings.scheduler, settings.certificates_folder)
    with data_folder.hold(settings.data):
        await _render_for_farm(settings, wanted)


async def _render_for_farm(settings: Settings, wanted: Security | None) -> None:
    command = EngineCommand(
        engine_program(settings),
        settings.threads_per_worker,
        settings.stall_seconds,
        settings.data,
        settings.memory_per_worker,
        settings.sandbox == "required",
    )
    host = worker_side.WorkerHost(command, settings.max_asset_bytes)
    # Files of scenes stay for a while, all else is of a life before.
    data_folder.sweep(settings.data, {}, (), settings.keep_assets_hours * 3600)
    worker_side.host = host
    await host.start()
    # It would look a hundred times a second at what its threads do, which is nothing.
    dask.config.set({"distributed.comm.timeouts.connect": "5s", "distributed.worker.profile.enabled": False})
    try:
        while True:
            with suppress(OSError, TimeoutError, asyncio.TimeoutError):
                async with Worker(
                    settings.scheduler, nthreads=WINDOW, memory_limit=0, dashboard=False, security=wanted
                ) as worker:
                    print(f"Fluxfarm worker joined {settings.scheduler} as {worker.address}", flush=True)
                    await worker.finished()
            log.warning("the worker is not in the farm, tries again", extra={"scheduler": settings.scheduler})
            await asyncio.sleep(RETRY_S)
    finally:
        await host.close()
