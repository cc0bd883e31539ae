"""Streams of a job: its events and its images as they come.

Both pull: each reader has a cursor into the ledger and waits for the job to change when it has read everything. So a
slow reader costs nothing but its socket, and one that was cut off goes on from its last event.
"""

import asyncio
import json
import uuid
from collections.abc import AsyncIterator
from typing import Annotated

from fastapi import APIRouter, Header
from fastapi.responses import StreamingResponse
from fastapi.sse import KEEPALIVE_COMMENT, EventSourceResponse, format_sse_event

from fluxfarm.api.deps import Farm, JobId, Services
from fluxfarm.api.images import EXR
from fluxfarm.api.problems import problem_responses
from fluxfarm.api.schemas import iso_time
from fluxfarm.domain.events import Event, EventKind
from fluxfarm.domain.job import TERMINAL_STATES
from fluxfarm.domain.records import Revision
from fluxfarm.errors import BadRequest, FarmError

router = APIRouter(tags=["streams"])
PAGE = 500
PING_INTERVAL_S = 15.0
CHUNK_BYTES = 1 << 16
JSON_LINES = "application/jsonl"


@router.get(
    "/v1/jobs/{job_id}/events",
    summary="Watch a job",
    # Not EventSourceResponse here: the framework would then take the route for a generator of one fixed form.
    response_class=StreamingResponse,
    responses=problem_responses(
        404,
        410,
        also={
            200: {
                "description": "Server-sent events, or JSON Lines if `Accept` asks for them.",
                "content": {"text/event-stream": {}, JSON_LINES: {}},
            }
        },
    ),
)
async def events(
    job_id: JobId,
    farm: Farm,
    accept: Annotated[str, Header(description="`application/jsonl` for one JSON object a line.")] = "",
    last_event_id: Annotated[
        str | None, Header(description="`id` of the last event that was read; the stream goes on after it.")
    ] = None,
) -> StreamingResponse:
    """All events of a job from the first one on, gap-free and in order, until its `end`.

    Kinds: `state`, `pass` (a revision was published), `tile`, `warning`, `end`. After a cut, reconnect with
    `Last-Event-ID` and nothing is missed.
    """
    await farm.ledger.job(job_id)
    if last_event_id and not (last_event_id.isascii() and last_event_id.isdigit() and len(last_event_id) <= 18):
        raise BadRequest("Last-Event-ID", last_event_id, "expected the id of an event, a whole number")
    after = int(last_event_id or 0)
    if JSON_LINES in accept or "application/x-ndjson" in accept:
        return StreamingResponse(_lines(farm, job_id, after), media_type=JSON_LINES)
    headers = {"Cache-Control": "no-cache", "X-Accel-Buffering": "no"}
    return EventSourceResponse(_server_sent(farm, job_id, after), headers=headers)


@router.get(
    "/v1/jobs/{job_id}/frames",
    summary="Stream the images",
    response_class=StreamingResponse,
    responses=problem_responses(
        404,
        410,
        also={
            200: {
                "description": "multipart/mixed; each part is one complete OpenEXR file with its Content-Length.",
                "content": {"multipart/mixed": {}},
            }
        },
    ),
)
async def frames(job_id: JobId, farm: Farm) -> StreamingResponse:
    """Every revision as it is published, from the newest one on, until the job ends.

    A reader that is slower than the job skips to the newest revision and always gets the last one.
    """
    await farm.ledger.job(job_id)
    boundary = f"fluxfarm-{uuid.uuid4().hex}"
    return StreamingResponse(_frames(farm, job_id, boundary), media_type=f"multipart/mixed; boundary={boundary}")


async def pull_events(farm: Services, job_id: str, after: int) -> AsyncIterator[Event | None]:
    """Events after the sequence number `after` until `end`; None when nothing happened for a while."""
    watch = farm.orchestrator.watch
    while not watch.closed:
        ticket = watch.ticket(job_id)
        page = await farm.ledger.events_after(job_id, after, PAGE)
        for event in page:
            yield event
            if event.kind is EventKind.END:
                return
            after = event.seq
        if len(page) == PAGE:
            continue
        try:
            if not page and (await farm.ledger.job(job_id)).state in TERMINAL_STATES:
                # The client has read the end before, unless the job ended between the two readings.
                if await farm.ledger.events_after(job_id, after, 1):
                    continue
                return
            await asyncio.wait_for(ticket.wait(), PING_INTERVAL_S)
        except FarmError:
            return  # deleted
        except TimeoutError:
            yield None


async def _server_sent(farm: Services, job_id: str, after: int) -> AsyncIterator[bytes]:
    async for event in pull_events(farm, job_id, after):
        if event is None:
            yield KEEPALIVE_COMMENT
        else:
            data = json.dumps(event.data | {"at": iso_time(event.at)}, separators=(",", ":"))
            yield format_sse_event(data_str=data, event=event.kind, id=str(event.seq))


async def _lines(farm: Services, job_id: str, after: int) -> AsyncIterator[bytes]:
    async for event in pull_events(farm, job_id, after):
        if event is not None:
            line = {"id": event.seq, "event": event.kind, "at": iso_time(event.at), "data": event.data}
            yield json.dumps(line, separators=(",", ":")).encode() + b"\n"


async def pull_revisions(farm: Services, job_id: str) -> AsyncIterator[Revision]:
    """The newest revision each time that one is asked for and there is a newer one, until the job ends."""
    sent, watch = 0, farm.orchestrator.watch
    while not watch.closed:
        ticket = watch.ticket(job_id)
        try:
            record = await farm.ledger.job(job_id)
        except FarmError:
            return  # deleted
        if record.newest is not None and record.newest.number > sent:
            sent = record.newest.number
            yield record.newest
        elif record.state in TERMINAL_STATES:
            return
        else:
            await ticket.wait()


async def _frames(farm: Services, job_id: str, boundary: str) -> AsyncIterator[bytes]:
    async for revision in pull_revisions(farm, job_id):
        try:
            file = farm.blobs.output(job_id, revision.exr).open("rb")
        except FileNotFoundError:
            return  # deleted
        with file:
            head = (
                f"--{boundary}\r\nContent-Type: {EXR}\r\nContent-Length: {revision.exr_bytes}\r\n"
                f'ETag: "{revision.exr}"\r\nX-Fluxfarm-Revision: {revision.number}\r\n'
                f"X-Fluxfarm-Samples: {revision.min_samples}\r\n\r\n"
            )
            yield head.encode()
            while chunk := await asyncio.to_thread(file.read, CHUNK_BYTES):
                yield chunk
            yield b"\r\n"
    yield f"--{boundary}--\r\n".encode()
