"""Jobs: create, look, steer, delete."""

import asyncio
import hashlib
import json
import re
import time
from typing import Annotated, Any

from fastapi import APIRouter, Header, Query, Response

from fluxfarm.api.access import Caller, own_job
from fluxfarm.api.deps import Farm, JobId, Services
from fluxfarm.api.problems import problem_responses
from fluxfarm.api.schemas import JobIn, JobOut, JobsOut, RevisionsOut, job_out, revision_out
from fluxfarm.domain.goal import Goal, Limits
from fluxfarm.domain.job import TERMINAL_STATES, JobState
from fluxfarm.domain.records import JobRequest
from fluxfarm.domain.scene import SceneBundle
from fluxfarm.domain.tiles import PixelRect
from fluxfarm.errors import BadRequest, UnknownBuiltin

router = APIRouter(tags=["jobs"])
LONGEST_WAIT_S = 60.0


@router.post(
    "/v1/jobs",
    summary="Submit a job",
    status_code=201,
    responses=problem_responses(
        409,
        413,
        429,
        also={200: {"model": JobOut, "description": "The Idempotency-Key made this job before."}},
    ),
)
async def create_job(
    body: JobIn,
    response: Response,
    farm: Farm,
    caller: Caller,
    idempotency_key: Annotated[
        str | None, Header(max_length=200, description="Sending the same key and body again gives the same job.")
    ] = None,
) -> JobOut:
    """Accept a scene to render.

    The reply comes when the job is stored safely: from then on it survives crashes and restarts. `Location` is its
    address. Every file of the scene must have been uploaded before.
    """
    request = await _checked(body, farm)
    body_sha256 = hashlib.sha256(json.dumps(body.model_dump(), sort_keys=True).encode()).hexdigest()
    job_id, new = await farm.orchestrator.create(request, idempotency_key, body_sha256, caller)
    response.headers["Location"] = f"/v1/jobs/{job_id}"
    if not new:
        response.status_code = 200
    return await _now(farm, job_id)


@router.get("/v1/jobs", summary="List jobs")
async def list_jobs(
    farm: Farm,
    state: Annotated[list[JobState] | None, Query(description="Only jobs in these states.")] = None,
    limit: Annotated[int, Query(ge=1, le=1000)] = 100,
) -> JobsOut:
    """Jobs, newest first."""
    records = await farm.ledger.jobs(state or (), limit)
    return JobsOut(jobs=[job_out(record, farm.orchestrator.progress(record)) for record in records])


@router.get("/v1/jobs/{job_id}", summary="Look at a job", responses=problem_responses(404, 410))
async def get_job(
    job_id: JobId,
    response: Response,
    farm: Farm,
    prefer: Annotated[
        str | None, Header(description="`wait=N`: reply when the job has ended, after N seconds at the latest.")
    ] = None,
) -> JobOut:
    """State, progress, plan and warnings of a job."""
    wait_s = _wait_seconds(prefer)
    if wait_s is not None:
        await _wait_for_end(farm, job_id, wait_s)
        response.headers["Preference-Applied"] = f"wait={wait_s:g}"
    return await _now(farm, job_id)


@router.post("/v1/jobs/{job_id}:cancel", summary="Give a job up", responses=problem_responses(404, 409, 410))
async def cancel_job(job_id: JobId, farm: Farm, caller: Caller) -> JobOut:
    """Stop a job for good. After the reply no tile of it is committed; revisions published before stay."""
    await own_job(farm, job_id, caller)
    await farm.orchestrator.cancel(job_id)
    return await _now(farm, job_id)


@router.post("/v1/jobs/{job_id}:pause", summary="Pause a job", responses=problem_responses(404, 409, 410))
async def pause_job(job_id: JobId, farm: Farm, caller: Caller) -> JobOut:
    """Stop a job for now; committed tiles are kept."""
    await own_job(farm, job_id, caller)
    await farm.orchestrator.pause(job_id)
    return await _now(farm, job_id)


@router.post("/v1/jobs/{job_id}:resume", summary="Resume a paused job", responses=problem_responses(404, 409, 410))
async def resume_job(job_id: JobId, farm: Farm, caller: Caller) -> JobOut:
    """Let a paused job go on where it stopped."""
    await own_job(farm, job_id, caller)
    await farm.orchestrator.resume(job_id)
    return await _now(farm, job_id)


@router.delete("/v1/jobs/{job_id}", summary="Delete a job", status_code=204, responses=problem_responses(404, 410))
async def delete_job(job_id: JobId, farm: Farm, caller: Caller) -> None:
    """Remove a job and all of its images; an unfinished one is cancelled first."""
    await own_job(farm, job_id, caller)
    await farm.orchestrator.delete(job_id)


@router.get("/v1/jobs/{job_id}/revisions", summary="List revisions", responses=problem_responses(404, 410))
async def list_revisions(job_id: JobId, farm: Farm) -> RevisionsOut:
    """All published images of a job, oldest first."""
    await farm.ledger.job(job_id)
    return RevisionsOut(revisions=[revision_out(revision) for revision in await farm.ledger.revisions(job_id)])


async def _now(farm: Services, job_id: str) -> JobOut:
    record = await farm.ledger.job(job_id)
    return job_out(record, farm.orchestrator.progress(record))


async def _checked(body: JobIn, farm: Services) -> JobRequest:
    """The request as the orchestrator takes it; raises BadRequest for what the schema alone cannot see."""
    size, crop = body.size, body.crop
    if size is not None and size.width * size.height > farm.max_pixels:
        raise BadRequest("size", f"{size.width}x{size.height}", f"expected at most {farm.max_pixels} pixels")
    if size is not None and crop is not None:
        frame = PixelRect(0, 0, size.width, size.height)
        if not frame.contains(PixelRect(crop.x, crop.y, crop.width, crop.height)):
            raise BadRequest("crop", crop.model_dump(), f"expected a part of the frame, {size.width}x{size.height}")
    goal: dict[str, Any] = {} if body.goal is None else body.goal.model_dump()
    return JobRequest(
        name=body.name,
        bundle=await _bundle(body, farm),
        builtin=body.scene.builtin,
        size=None if size is None else (size.width, size.height),
        crop=None if crop is None else PixelRect(crop.x, crop.y, crop.width, crop.height),
        integrator=body.integrator,
        goal=Goal(**goal),
        limits=Limits(**body.limits.model_dump()),
        priority=body.priority,
        seed=body.seed,
    )


async def _bundle(body: JobIn, farm: Services) -> SceneBundle:
    scene = body.scene
    if scene.builtin is None:
        assert scene.entry is not None and scene.files is not None
        return SceneBundle(scene.entry, scene.files)
    known = [] if farm.scenes is None else sorted(path.parent.name for path in farm.scenes.glob("*/scene.xml"))
    if farm.scenes is None or scene.builtin not in known:
        raise UnknownBuiltin("scene.builtin", scene.builtin, f"expected one of {', '.join(known) or 'none'}")
    return await farm.blobs.put_builtin(farm.scenes / scene.builtin)


def _wait_seconds(prefer: str | None) -> float | None:
    """N of `wait=N` in a Prefer header (RFC 7240), at most LONGEST_WAIT_S; None if there is none."""
    found = re.search(r"(?:^|[,;\s])wait\s*=\s*\"?(\d{1,9})\"?", prefer or "")
    return None if found is None else min(float(found[1]), LONGEST_WAIT_S)


async def _wait_for_end(farm: Services, job_id: str, wait_s: float) -> None:
    """Return when the job has ended, or after `wait_s` seconds."""
    end = time.monotonic() + wait_s
    while not farm.orchestrator.watch.closed:
        ticket = farm.orchestrator.watch.ticket(job_id)
        if (await farm.ledger.job(job_id)).state in TERMINAL_STATES:
            return
        try:
            await asyncio.wait_for(ticket.wait(), end - time.monotonic())
        except TimeoutError:
            return
