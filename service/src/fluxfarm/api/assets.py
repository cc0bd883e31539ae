"""Uploading the files of scenes, by their digests."""

from collections.abc import AsyncIterator
from typing import Annotated

from fastapi import APIRouter, Path, Request, Response

from fluxfarm.api.access import Caller
from fluxfarm.api.body_guard import MAX_DRAINED_BYTES
from fluxfarm.api.deps import Farm
from fluxfarm.api.problems import problem_responses
from fluxfarm.api.schemas import AssetOut, MissingIn, MissingOut
from fluxfarm.domain.scene import SHA256_PATTERN
from fluxfarm.errors import QuotaExceeded, TooLarge

router = APIRouter(tags=["assets"])
# Usage leaves the day hour by hour.
RETRY_S = 3600


@router.put(
    "/v1/assets/{sha256}",
    summary="Upload a file",
    status_code=201,
    responses=problem_responses(413, 429, also={200: {"model": AssetOut, "description": "It was there already."}}),
    openapi_extra={"requestBody": {"required": True, "content": {"application/octet-stream": {}}}},
)
async def put_asset(
    sha256: Annotated[str, Path(pattern=SHA256_PATTERN, description="SHA-256 of the body, lower-case hexadecimal.")],
    request: Request,
    response: Response,
    farm: Farm,
    caller: Caller,
) -> AssetOut:
    """Store one file of a scene under its SHA-256.

    The body is the file itself. It is kept only if its digest is the one in the address; sending it again is harmless.
    """
    body = request.stream()
    stream = _Counted(body, None if caller is None else await farm.ledger.bytes_left(caller))
    try:
        new = await farm.blobs.put_asset(sha256, stream)
    except (TooLarge, QuotaExceeded):
        await _drain(body)
        raise
    finally:
        if caller is not None and stream.bytes > 0:
            await farm.ledger.note_upload(caller.id, stream.bytes)
    response.status_code = 201 if new else 200
    return AssetOut(sha256=sha256)


@router.post("/v1/assets:missing", summary="Ask which files to upload", responses=problem_responses(413))
async def missing_assets(wanted: MissingIn, farm: Farm) -> MissingOut:
    """Of the given digests, name those that are not stored yet."""
    return MissingOut(missing=farm.blobs.missing_assets(wanted.sha256))


class _Counted:
    """A body as it comes, counted, up to `most` bytes: beyond them QuotaExceeded is raised."""

    def __init__(self, chunks: AsyncIterator[bytes], most: int | None) -> None:
        self._chunks = chunks
        self._most = most
        self.bytes = 0

    def __aiter__(self) -> "_Counted":
        return self

    async def __anext__(self) -> bytes:
        chunk = await anext(self._chunks)
        self.bytes += len(chunk)
        if self._most is not None and self.bytes > self._most:
            raise QuotaExceeded(f"upload: longer than the {self._most} bytes left to this key for 24 hours", RETRY_S)
        return chunk


async def _drain(stream: AsyncIterator[bytes]) -> None:
    """Read some of what is too much: a client reads the reply only when it has sent its body."""
    length = 0
    async for chunk in stream:
        length += len(chunk)
        if length > MAX_DRAINED_BYTES:
            return
