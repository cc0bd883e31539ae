"""What the routes need, as named types."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

from fastapi import Depends, Request
from fastapi import Path as PathParameter

from fluxfarm.orchestrator import Orchestrator
from fluxfarm.orchestrator.key_ring import KeyRing
from fluxfarm.ports import BlobStore, Ledger, WorkerPool


@dataclass(frozen=True, slots=True)
class Services:
    """The parts that the routes talk to, and fixed facts about this service. `keys`: None where none are asked for."""

    orchestrator: Orchestrator
    ledger: Ledger
    blobs: BlobStore
    pool: WorkerPool
    keys: KeyRing | None
    scenes: Path | None
    data: Path
    settings: dict[str, str | int | float]
    warnings: list[str]
    max_pixels: int
    max_asset_bytes: int


def services(request: Request) -> Services:
    """The services of the application that handles the request."""
    found = request.app.state.services
    assert isinstance(found, Services)
    return found


Farm = Annotated[Services, Depends(services)]
JobId = Annotated[str, PathParameter(description="Id of the job, from the reply to POST /v1/jobs.", max_length=64)]
