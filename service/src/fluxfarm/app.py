"""Wires the parts together: settings in, a running service out."""

import asyncio
import logging
import socket
from collections.abc import Callable
from contextlib import AsyncExitStack
from dataclasses import asdict

import uvicorn
from fastapi import Depends, FastAPI

import fluxfarm
from fluxfarm.adapters import data_folder
from fluxfarm.adapters.blobs import FileBlobStore
from fluxfarm.adapters.engine.local_pool import LocalPool
from fluxfarm.adapters.engine.process import EngineCommand
from fluxfarm.adapters.ledger import SqliteLedger
from fluxfarm.adapters.ledger.database import sqlite_warning
from fluxfarm.api import assets, images, jobs, keys, problems, report, streams, system
from fluxfarm.api.access import authorize
from fluxfarm.api.body_guard import BodyGuard
from fluxfarm.api.deps import Services
from fluxfarm.api.problems import problem_responses
from fluxfarm.errors import StartError
from fluxfarm.orchestrator import Orchestrator
from fluxfarm.orchestrator.key_ring import KeyRing, new_secret
from fluxfarm.orchestrator.orchestrator import OrchestratorSettings
from fluxfarm.ports import WorkerPool
from fluxfarm.settings import OWNER_KEY_FILE, Settings, engine_program, scenes_folder

log = logging.getLogger(__name__)

DESCRIPTION = """
Give Fluxfarm a scene and an error target, a time budget or a sample count; it renders in tiles and passes and returns
OpenEXR images with their error. Upload the files of a scene by digest, submit a job, watch its events, fetch the
newest image at any time. Errors are RFC 9457 problem details.
"""
GRACE_S = 2


def create_app() -> FastAPI:
    """The routes; `app.state.services` has to be set before the first request."""
    app = FastAPI(title="Fluxfarm", version=fluxfarm.__version__, description=DESCRIPTION)
    app.add_middleware(BodyGuard)
    problems.install(app)
    for room in (assets, jobs, streams, images, report, system, keys):
        app.include_router(room.router, dependencies=[Depends(authorize)], responses=problem_responses(401, 403, 422))
    return app


async def start_services(settings: Settings, stack: AsyncExitStack) -> Services:
    """Open the data folder, start the engine processes, resume unfinished jobs; `stack` closes all of it.

    Raises StartError."""
    program = engine_program(settings)
    stack.enter_context(data_folder.hold(settings.data))
    durable = settings.sync == "full"
    ledger = SqliteLedger(settings.data / "ledger.sqlite3", settings.journal, durable)
    stack.callback(ledger.close)
    blobs = FileBlobStore(settings.data, settings.max_asset_bytes, durable, settings.least_free_bytes)
    stack.callback(blobs.close)
    kept = {sha256 for record in await ledger.jobs() for sha256 in record.request.bundle.files.values()}
    swept = data_folder.sweep(settings.data, await ledger.files(), kept, settings.keep_assets_hours * 3600)
    engine = EngineCommand(
        program,
        settings.threads_per_worker,
        settings.stall_seconds,
        settings.data,
        settings.memory_per_worker,
        settings.sandbox == "required",
    )
    pool = _pool(settings, engine)
    limits = OrchestratorSettings(
        settings.tile_size, settings.lease_seconds, settings.max_pixels, settings.least_free_bytes
    )
    orchestrator = Orchestrator(ledger, blobs, pool, limits)
    stack.push_async_callback(orchestrator.close)
    await orchestrator.start()
    ring = await _key_ring(settings, ledger) if settings.asks_for_keys else None
    warnings = [] if (warning := sqlite_warning()) is None else [warning]
    if ring is None and not settings.on_loopback:
        warnings.append(f"anybody who reaches {settings.host} may do anything: FLUXFARM_KEYS = off")
    log.info("service started", extra={"data": str(settings.data), "swept_files": swept, "warnings": warnings})
    return Services(
        orchestrator=orchestrator,
        ledger=ledger,
        blobs=blobs,
        pool=pool,
        keys=ring,
        scenes=scenes_folder(settings),
        data=settings.data,
        settings={name: _plain(value) for name, value in asdict(settings).items()},
        warnings=warnings,
        max_pixels=settings.max_pixels,
        max_asset_bytes=settings.max_asset_bytes,
    )


def _pool(settings: Settings, engine: EngineCommand) -> WorkerPool:
    """Engine processes of this machine; with the backend dask those of a farm, and one here to prepare and merge."""
    if settings.backend == "local":
        return LocalPool(engine, settings.workers)
    try:
        # Only here, since it takes a second to load.
        from fluxfarm.adapters.dask import dask_logs
        from fluxfarm.adapters.dask.pool import DaskPool
    except ImportError as error:
        raise StartError(f"FLUXFARM_BACKEND = dask: needs the extra fluxfarm[dask]: {error}") from None
    dask_logs.send_to_ours()
    return DaskPool(LocalPool(engine, 1), settings.scheduler, settings.certificates_folder)


async def _key_ring(settings: Settings, ledger: SqliteLedger) -> KeyRing:
    """The keys. That of the machine's owner is in a file of the data folder, and made where the file is not there."""
    ring = KeyRing(ledger)
    await ring.load()
    path = settings.data / OWNER_KEY_FILE
    known = path.read_text().strip() if path.is_file() else ""
    if ring.find(known) is None:
        secret = new_secret()
        data_folder.write_secret(path, secret)
        await ring.renew_owner(secret)
        log.warning("made a new API key for the owner", extra={"file": str(path)})
    return ring


class Server(uvicorn.Server):
    """An HTTP server that lets open streams end as soon as it is asked to stop."""

    def __init__(self, app: FastAPI, settings: Settings) -> None:
        self._app = app
        super().__init__(
            uvicorn.Config(
                app,
                host=settings.host,
                port=settings.port,
                log_config=None,
                access_log=False,
                timeout_graceful_shutdown=GRACE_S,
                http="h11",
                ws="none",
                loop="asyncio",
                lifespan="off",
            )
        )

    async def shutdown(self, sockets: list[socket.socket] | None = None) -> None:
        """Wake the readers of streams, then close as usual."""
        self._app.state.services.orchestrator.watch.close()
        await super().shutdown(sockets)

    def abort(self) -> None:
        """Close every connection at once."""
        for listener in self.servers:
            listener.close()
        for connection in self.server_state.connections:
            if connection.transport is not None:
                connection.transport.close()


async def serve(settings: Settings, listening: socket.socket, ready: Callable[[Server], None]) -> None:
    """Run the service on a bound socket until the server given to `ready` is told to stop; raises StartError.

    Cancelled, it ends without waiting for those that it serves."""
    async with AsyncExitStack() as stack:
        app = create_app()
        app.state.services = await start_services(settings, stack)
        server = Server(app, settings)
        ready(server)
        try:
            await server.serve(sockets=[listening])
        except asyncio.CancelledError:
            server.abort()
            raise


def bind(settings: Settings) -> socket.socket:
    """A socket on the service's address; raises StartError if that is taken."""
    listening = socket.socket(socket.AF_INET6 if ":" in settings.host else socket.AF_INET)
    listening.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    try:
        listening.bind((settings.host, settings.port))
    except OSError as error:
        listening.close()
        raise StartError(
            f"FLUXFARM_HOST, FLUXFARM_PORT = {settings.host}:{settings.port}: cannot listen there ({error.strerror}); "
            "another service may run already"
        ) from None
    return listening


def _plain(value: object) -> str | int | float:
    return value if isinstance(value, int | float) else str(value)
