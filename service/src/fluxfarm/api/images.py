"""Images of a job: the newest, any revision, the preview and single tiles."""

import hashlib
import re
from pathlib import Path
from typing import Annotated

from fastapi import APIRouter, Request, Response
from fastapi import Path as PathParameter
from fastapi.responses import FileResponse
from starlette.background import BackgroundTask

from fluxfarm.api.deps import Farm, JobId, Services
from fluxfarm.api.problems import problem, problem_responses
from fluxfarm.domain.records import Revision
from fluxfarm.errors import Conflict, NotYetThere

router = APIRouter(tags=["images"])
EXR = "image/x-exr"
PNG = "image/png"
# Each chunk is a trip to a thread and back.
CHUNK_BYTES = 1 << 20
_SINGLE_RANGE = re.compile(r"bytes=(\d{1,18}-\d{0,18}|-\d{1,18})")


def _image(media_type: str) -> dict[int | str, dict[str, object]]:
    found: dict[int | str, dict[str, object]] = {
        200: {"description": "The image.", "content": {media_type: {}}},
        206: {"description": "The part named by `Range`.", "content": {media_type: {}}},
        304: {"description": "The image with the `If-None-Match` tag is still the newest."},
        416: {"description": "The image has no such part."},
    }
    return found | problem_responses(404, 410)


@router.head("/v1/jobs/{job_id}/image.exr", include_in_schema=False)
@router.get(
    "/v1/jobs/{job_id}/image.exr",
    summary="Newest image",
    response_class=FileResponse,
    responses=_image(EXR),
)
async def newest_image(job_id: JobId, request: Request, farm: Farm) -> Response:
    """The newest complete revision as OpenEXR, at any time after the first pass.

    The entity tag is strong: it changes exactly when the bytes do. `Range` and `If-None-Match` are honoured.
    """
    revision = await _newest(farm, job_id)
    return image_response(request, farm.blobs.output(job_id, revision.exr), revision.exr, EXR, revision)


@router.get(
    "/v1/jobs/{job_id}/revisions/{number}/image.exr",
    summary="Image of one revision",
    response_class=FileResponse,
    responses=_image(EXR),
)
async def revision_image(
    job_id: JobId,
    number: Annotated[int, PathParameter(ge=1, description="Number of the revision, counting from 1.")],
    request: Request,
    farm: Farm,
) -> Response:
    """One revision as OpenEXR. A revision never changes."""
    newest = await _newest(farm, job_id)
    revision = next((r for r in await farm.ledger.revisions(job_id) if r.number == number), None)
    if revision is None:
        raise NotYetThere(f"job {job_id}: revision {number} is not there, the newest is {newest.number}")
    return image_response(request, farm.blobs.output(job_id, revision.exr), revision.exr, EXR, revision)


@router.get(
    "/v1/jobs/{job_id}/preview.png",
    summary="Newest image as PNG",
    response_class=FileResponse,
    responses=_image(PNG),
)
async def preview(job_id: JobId, request: Request, farm: Farm) -> Response:
    """The newest revision for the eye: 8 bits, sRGB."""
    revision = await _newest(farm, job_id)
    return image_response(request, farm.blobs.output(job_id, revision.png), revision.png, PNG, revision)


@router.get(
    "/v1/jobs/{job_id}/tiles/{column}-{row}.exr",
    summary="One tile",
    response_class=FileResponse,
    responses=_image(EXR) | problem_responses(404, 410, 503),
)
async def tile(
    job_id: JobId,
    column: Annotated[int, PathParameter(ge=0, description="Column of the tile, from the left, counting from 0.")],
    row: Annotated[int, PathParameter(ge=0, description="Row of the tile, from the top, counting from 0.")],
    request: Request,
    farm: Farm,
) -> Response:
    """One tile with all of its samples so far, as OpenEXR whose data window is the tile's place in the frame."""
    path = await farm.orchestrator.tile_image(job_id, column, row)
    sha256 = hashlib.sha256(path.read_bytes()).hexdigest()
    response = image_response(request, path, sha256, EXR, None)
    response.background = BackgroundTask(path.unlink, missing_ok=True)
    return response


def image_response(request: Request, path: Path, sha256: str, media_type: str, revision: Revision | None) -> Response:
    """The file with its digest as strong entity tag, or 304 if the client has it."""
    tag = f'"{sha256}"'
    headers = {"ETag": tag, "Cache-Control": "no-cache"}
    if revision is not None:
        headers["X-Fluxfarm-Revision"] = str(revision.number)
        headers["X-Fluxfarm-Samples"] = str(revision.min_samples)
    known = re.findall(r'(?:W/)?("[^"]*"|\*)', request.headers.get("if-none-match", ""))
    if tag in known or "*" in known:
        return Response(status_code=304, headers=headers)
    try:
        size = path.stat().st_size
    except FileNotFoundError:
        return problem(Conflict.status, Conflict.code, "the image was removed meanwhile; ask again", request.url.path)
    wanted = request.headers.get("range", "")
    if not _SINGLE_RANGE.fullmatch(wanted):  # none, several or nonsense: the whole image, as RFC 9110 allows
        request.scope["headers"] = [entry for entry in request.scope["headers"] if entry[0] != b"range"]
    elif unsatisfiable(wanted, size) and "if-range" not in request.headers:
        detail = f"Range = {wanted!r}: the image has {size} bytes"
        return problem(
            416, "range-not-satisfiable", detail, extra=None, headers=headers | {"Content-Range": f"bytes */{size}"}
        )
    response = FileResponse(path, media_type=media_type, headers=headers, stat_result=path.stat())
    response.chunk_size = CHUNK_BYTES
    return response


def unsatisfiable(text: str, size: int) -> bool:
    """Whether a single Range asks only for bytes that a file of `size` bytes does not have."""
    begin, end = text.removeprefix("bytes=").split("-")
    return int(begin) >= size or (end != "" and int(end) < int(begin)) if begin else int(end) == 0


async def _newest(farm: Services, job_id: str) -> Revision:
    record = await farm.ledger.job(job_id)
    if record.newest is None:
        raise NotYetThere(f"job {job_id}: state {record.state}, no revision yet; the first comes after the first pass")
    return record.newest
