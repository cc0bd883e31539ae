"""Takes the files of a merged pass to their final names, records the revision and drops what it replaces."""

import asyncio
import time
from pathlib import Path

from fluxfarm.domain.leases import Merged
from fluxfarm.domain.records import Revision
from fluxfarm.errors import StaleLease
from fluxfarm.failpoints import reach
from fluxfarm.ports import BlobStore, Ledger


async def publish(
    ledger: Ledger, blobs: BlobStore, merged: Merged, before: Revision | None, film_before: str | None, running_s: float
) -> Revision:
    """Make one revision durable and visible; returns it.

    Raises StaleLease if the job was stopped meanwhile, OSError if the disk refuses. If there is a new film, the film
    before and the tiles that are in the new one are removed at the end: nothing refers to them any more."""
    lease = merged.lease
    written = [path for path in (lease.exr_out, lease.png_out, lease.film_out) if path is not None]
    adopted = await asyncio.gather(*(blobs.adopt(lease.job_id, path) for path in written))
    (exr, exr_bytes), (png, _) = adopted[:2]
    film = adopted[2][0] if len(adopted) > 2 else None
    revision = Revision(
        number=1 if before is None else before.number + 1,
        passes=lease.passes,
        min_samples=merged.min_samples,
        max_samples=merged.max_samples,
        mean_samples=merged.mean_samples,
        error_noise=merged.error_noise,
        error_bias=merged.error_bias,
        mean=merged.mean,
        non_finite_samples=merged.non_finite_samples,
        running_s=running_s,
        exr=exr,
        exr_bytes=exr_bytes,
        png=png,
        film=film,
        at=time.time(),
        error_bound=merged.error_bound,
        next_round=merged.next_round,
        samples_expected=merged.samples_expected,
        error_unseen=merged.error_unseen,
        unseen_warning=merged.unseen_warning,
    )
    kept = {film_before} if before is None else {film_before, before.exr, before.png}
    try:
        tiles = await ledger.record_revision(lease.fence, lease.job_id, revision)
    except StaleLease:
        await blobs.drop([blobs.output(lease.job_id, sha256) for sha256, _ in adopted if sha256 not in kept])
        raise
    reach("revision-recorded")
    unused: list[Path] = [blobs.tile(lease.job_id, sha256) for sha256 in tiles]
    if film is not None and film_before is not None and film_before != film:
        unused.append(blobs.output(lease.job_id, film_before))
    await blobs.drop(unused)
    reach("revision-cleared")
    return revision
