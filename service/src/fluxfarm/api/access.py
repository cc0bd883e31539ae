"""Who asks, and whether they may: one dependency that every route has."""

from typing import Annotated

from fastapi import Depends, Request, Security
from fastapi.security import HTTPAuthorizationCredentials, HTTPBearer

from fluxfarm.api.deps import Farm, Services
from fluxfarm.domain.access import ApiKey, Scope
from fluxfarm.errors import Forbidden, Unauthorized

_bearer = HTTPBearer(
    auto_error=False,
    scheme_name="key",
    description="An API key; asked for when the service listens to other machines. `fluxfarm keys` makes them.",
)
ADMIN_TAG = "keys"


def scope_of(method: str, tags: list[str]) -> Scope:
    """What a route asks for: looking is `read`, changing is `submit`, keys are for `admin`."""
    if ADMIN_TAG in tags:
        return Scope.ADMIN
    return Scope.READ if method in ("GET", "HEAD") else Scope.SUBMIT


async def authorize(
    request: Request, farm: Farm, sent: Annotated[HTTPAuthorizationCredentials | None, Security(_bearer)]
) -> ApiKey | None:
    """The key of the request, None where none are asked for; raises Unauthorized or Forbidden."""
    if farm.keys is None:
        return None
    key = None if sent is None else farm.keys.find(sent.credentials)
    if key is None:
        what = "no API key" if sent is None else "an API key that is not known here"
        raise Unauthorized(f"{request.url.path}: {what}, expected the header `Authorization: Bearer` and a key")
    wanted = scope_of(request.method, request.scope["route"].tags)
    if not key.scope.allows(wanted):
        raise Forbidden(f"{request.method} {request.url.path}: key {key.name!r} has scope {key.scope}, needs {wanted}")
    return key


# None where the service asks nobody for keys.
Caller = Annotated[ApiKey | None, Depends(authorize)]


async def own_job(farm: Services, job_id: str, caller: ApiKey | None) -> None:
    """Return if `caller` may change the job: those of others are for `admin`. Raises Forbidden, JobNotFound or Gone."""
    record = await farm.ledger.job(job_id)
    if caller is not None and caller.scope is not Scope.ADMIN and record.owner != caller.id:
        raise Forbidden(f"job {job_id}: was submitted with another key, and key {caller.name!r} is not of scope admin")
