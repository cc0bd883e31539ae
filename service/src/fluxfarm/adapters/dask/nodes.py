"""The processes of a farm beside the service: its scheduler, and workers that come, go and come back."""

import asyncio
import logging
from contextlib import suppress

import dask
from distributed import Scheduler, Worker

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
    address = settings.scheduler
    async with Scheduler(host=address, dashboard=False, security=wanted) as scheduler:
        print(f"Fluxfarm scheduler listens on {scheduler.address}", flush=True)
        await scheduler.finished()


async def run_worker(settings: Settings) -> None:
    """Render for the farm until cancelled; joins again whenever the scheduler was away. Raises BadSetting."""
    wanted = security(settings.scheduler, settings.certificates_folder)
    command = EngineCommand(
        engine_program(settings),
        settings.threads_per_worker,
        settings.stall_seconds,
        settings.data,
        settings.memory_per_worker,
        settings.sandbox == "required",
    )
    host = worker_side.WorkerHost(command, settings.max_asset_bytes)
    worker_side.host = host
    await host.start()
    dask.config.set({"distributed.comm.timeouts.connect": "5s"})
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
