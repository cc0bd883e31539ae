"""Single tiles as images of their own: which film and which tiles an engine process needs for one."""

import uuid

from fluxfarm.domain.leases import ImageInfo, WriteTileLease
from fluxfarm.errors import NotYetThere, TileOutsideFrame
from fluxfarm.ports import BlobStore, Ledger


async def tile_lease(
    ledger: Ledger, blobs: BlobStore, job_id: str, place: tuple[int, int], fence: int
) -> WriteTileLease:
    """The lease that writes the tile at `place` (column, row) with all samples committed so far.

    Raises NotYetThere or TileOutsideFrame."""
    column, row = place
    record = await ledger.job(job_id)
    if record.grid is None or record.facts is None:
        raise NotYetThere(f"job {job_id}: state {record.state}, it has no tiles before its scene is prepared")
    tile = record.grid.index(column, row)
    if tile is None:
        raise TileOutsideFrame(
            f"tile {column}-{row}: expected a column below {record.grid.columns} and a row below {record.grid.rows}"
        )
    unmerged = await ledger.unmerged(job_id)
    film, stored = unmerged.film, [t.sha256 for t in unmerged.tiles if t.tile == tile]
    if film is None and not stored:
        raise NotYetThere(f"tile {column}-{row} of job {job_id}: not rendered yet")
    return WriteTileLease(
        fence=fence,
        job_id=job_id,
        width=record.facts.width,
        height=record.facts.height,
        rect=record.grid.rect(tile),
        film_in=None if film is None else blobs.output(job_id, film),
        tiles=tuple(blobs.tile(job_id, sha256) for sha256 in stored),
        exr_out=blobs.scratch(job_id, f"{uuid.uuid4().hex}.exr"),
        info=ImageInfo(job_id, record.request.bundle.digest(), record.facts.integrator, record.request.seed),
    )
