"""Takes the files of a merged pass to their final names, records the revision and drops what it replaces."""

import asyncio
import time
from pathlib import Path

from fluxfarm.domain.leases import Merged
from fluxfarm.domain.records import Revision
from fluxfarm.errors import StaleLease
from fluxfarm.ports import BlobStore, Ledger


async def publish(
    ledger: Ledger, blobs: BlobStore, merged: Merged, before: Revision | None, running_s: float
) -> Revision:
    """Make one revision durable and visible; returns it.

    Raises StaleLease if the job was stopped meanwhile, OSError if the disk refuses. The film before and the tiles that
    are in the new film are removed at the end: nothing refers to them any more."""
    lease = merged.lease
    (film, _), (exr, exr_bytes), (png, _) = await asyncio.gather(
        *(blobs.adopt(lease.job_id, path) for path in (lease.film_out, lease.exr_out, lease.png_out))
    )
    revision = Revision(
        number=1 if before is None else before.number + 1,
        passes=lease.passes,
        min_samples=merged.min_samples,
        max_samples=merged.max_samples,
        error_noise=merged.error_noise,
        mean=merged.mean,
        non_finite_samples=merged.non_finite_samples,
        running_s=running_s,
        exr=exr,
        exr_bytes=exr_bytes,
        png=png,
        film=film,
        at=time.time(),
    )
    kept = set() if before is None else {before.exr, before.png, before.film}
    try:
        tiles = await ledger.record_revision(lease.fence, lease.job_id, revision)
    except StaleLease:
        await blobs.drop([blobs.output(lease.job_id, sha256) for sha256 in (film, exr, png) if sha256 not in kept])
        raise
    unused: list[Path] = [blobs.tile(lease.job_id, sha256) for sha256 in tiles]
    if before is not None and before.film is not None and before.film != film:
        unused.append(blobs.output(lease.job_id, before.film))
    await blobs.drop(unused)
    return revision
