"""The service itself: its workers, its parts, its health, its metrics."""

import platform
import shutil
import sqlite3

import fastapi
from fastapi import APIRouter, Response
from fastapi.responses import PlainTextResponse
from pydantic import BaseModel, Field
from starlette.status import HTTP_503_SERVICE_UNAVAILABLE

import fluxfarm
from fluxfarm.api.deps import Farm
from fluxfarm.api.problems import problem_responses

router = APIRouter(tags=["system"])
LEAST_FREE_BYTES = 1 << 30


class WorkerOut(BaseModel):
    """One engine process. States: STARTING, READY, WORKING, BROKEN (does not start); of a farm also UNKNOWN (does not
    answer) and REFUSED (of another build, see `last_words`)."""

    id: int
    state: str
    host: str = Field(description="Machine that it runs on; empty: this one.")
    pid: int | None
    threads: int
    engine_build: str
    restarts: int = Field(description="How often the process in this place was replaced.")
    jobs: list[str] = Field(description="Jobs whose leases it holds, oldest first.")
    sandbox_missing: list[str] = Field(description="What of its sandbox the kernel does not hold; empty: nothing.")
    last_words: str = Field(description="Why the process before ended.")


class WorkersOut(BaseModel):
    """All engine processes."""

    workers: list[WorkerOut]


class SystemOut(BaseModel):
    """What this service is made of."""

    version: str
    python: str
    fastapi: str
    sqlite_version: str
    engine_builds: list[str]
    settings: dict[str, str | int | float]
    disk_free_bytes: int
    warnings: list[str]


class HealthOut(BaseModel):
    """`ok`, or why not."""

    status: str


@router.get("/v1/workers", summary="Engine processes")
async def workers(farm: Farm) -> WorkersOut:
    """The engine processes and what they work on."""
    return WorkersOut(
        workers=[
            WorkerOut(
                id=worker.id,
                state=worker.state,
                host=worker.host,
                pid=worker.pid,
                threads=worker.threads,
                engine_build=worker.engine_build,
                restarts=worker.restarts,
                jobs=list(dict.fromkeys(job_id for _, job_id in worker.leases)),
                sandbox_missing=list(worker.sandbox_missing),
                last_words=worker.last_words,
            )
            for worker in farm.pool.workers()
        ]
    )


@router.get("/v1/system", summary="Versions and settings")
async def system(farm: Farm) -> SystemOut:
    """Versions, settings and free space, with what the owner should know about them."""
    free = shutil.disk_usage(farm.data).free
    builds = sorted({worker.engine_build for worker in farm.pool.workers() if worker.engine_build})
    warnings = list(farm.warnings)
    if free < LEAST_FREE_BYTES:
        warnings.append(f"{free} bytes free in {farm.data}, expected at least {LEAST_FREE_BYTES}")
    missing = sorted({part for worker in farm.pool.workers() for part in worker.sandbox_missing})
    if missing:
        warnings.append(f"engine processes are not wholly shut in, without: {', '.join(missing)}")
    if len(builds) > 1:
        warnings.append(
            f"engine processes of different builds: {', '.join(builds)}; pixels may differ, restart the service"
        )
    return SystemOut(
        version=fluxfarm.__version__,
        python=platform.python_version(),
        fastapi=fastapi.__version__,
        sqlite_version=sqlite3.sqlite_version,
        engine_builds=builds,
        settings=farm.settings,
        disk_free_bytes=free,
        warnings=warnings,
    )


@router.get(
    "/healthz",
    summary="Health",
    responses=problem_responses(also={503: {"model": HealthOut, "description": "It cannot render."}}),
)
async def healthz(farm: Farm, response: Response) -> HealthOut:
    """200 while the ledger answers and an engine process starts; for load balancers."""
    await farm.ledger.highest_fence()
    if all(worker.state == "BROKEN" for worker in farm.pool.workers()):
        response.status_code = HTTP_503_SERVICE_UNAVAILABLE
        return HealthOut(status="no engine process starts; see /v1/workers")
    return HealthOut(status="ok")


@router.get("/metrics", summary="Metrics", response_class=PlainTextResponse)
async def metrics(farm: Farm) -> PlainTextResponse:
    """Counters and histograms in the Prometheus text format, without labels for single jobs."""
    from fluxfarm.api.metrics import exposition

    return PlainTextResponse(await exposition(farm), media_type="text/plain; version=0.0.4; charset=utf-8")
