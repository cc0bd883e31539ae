"""Uploading the files of scenes, by their digests."""

from typing import Annotated

from fastapi import APIRouter, Path, Request, Response

from fluxfarm.api.deps import Farm
from fluxfarm.api.problems import problem_responses
from fluxfarm.api.schemas import AssetOut, MissingIn, MissingOut
from fluxfarm.domain.scene import SHA256_PATTERN
from fluxfarm.errors import TooLarge

router = APIRouter(tags=["assets"])


@router.put(
    "/v1/assets/{sha256}",
    summary="Upload a file",
    status_code=201,
    responses=problem_responses(413, 422, also={200: {"model": AssetOut, "description": "It was there already."}}),
    openapi_extra={"requestBody": {"required": True, "content": {"application/octet-stream": {}}}},
)
async def put_asset(
    sha256: Annotated[str, Path(pattern=SHA256_PATTERN, description="SHA-256 of the body, lower-case hexadecimal.")],
    request: Request,
    response: Response,
    farm: Farm,
) -> AssetOut:
    """Store one file of a scene under its SHA-256.

    The body is the file itself. It is kept only if its digest is the one in the address; sending it again is harmless.
    """
    announced = request.headers.get("content-length", "")
    if announced.isdigit() and int(announced) > farm.max_asset_bytes:
        raise TooLarge(f"asset {sha256}: {announced} bytes, expected at most {farm.max_asset_bytes}")
    if not await farm.blobs.put_asset(sha256, request.stream()):
        response.status_code = 200
    return AssetOut(sha256=sha256)


@router.post("/v1/assets:missing", summary="Ask which files to upload", responses=problem_responses(413, 422))
async def missing_assets(wanted: MissingIn, farm: Farm) -> MissingOut:
    """Of the given digests, name those that are not stored yet."""
    return MissingOut(missing=farm.blobs.missing_assets(wanted.sha256))
