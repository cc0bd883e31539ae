"""API keys: make, list, drop. Only for keys of scope admin."""

from typing import Annotated, Literal

from fastapi import APIRouter
from fastapi import Path as PathParameter
from pydantic import BaseModel, Field

from fluxfarm.api.access import ADMIN_TAG
from fluxfarm.api.deps import Farm, Services
from fluxfarm.api.problems import problem_responses
from fluxfarm.api.schemas import Name, Strict, iso_time
from fluxfarm.domain.access import ApiKey, Quota, Scope
from fluxfarm.errors import NotFound
from fluxfarm.orchestrator.key_ring import KeyRing

router = APIRouter(tags=[ADMIN_TAG])
MOST = (1 << 63) - 1
KeyId = Annotated[str, PathParameter(description="Id of the key, from GET /v1/keys.", max_length=64)]


class QuotaIn(Strict):
    """The most that the key may have; absent: any."""

    jobs: int | None = Field(default=None, ge=0, le=MOST, description="Unfinished jobs at once.")
    bytes_a_day: int | None = Field(default=None, ge=0, le=MOST, description="Uploaded bytes in 24 hours.")
    samples_a_day: int | None = Field(
        default=None, ge=0, le=MOST, description="Camera samples, pixels times samples of each, in 24 hours."
    )


class KeyIn(Strict):
    """A key to make."""

    name: Name = Field(min_length=1, description="Whose it is, for people.")
    scope: Literal["read", "submit", "admin"] = Field(
        description="`read`: look at everything; `submit`: also upload, submit and steer its own jobs; `admin`: all."
    )
    quota: QuotaIn = Field(default_factory=QuotaIn)


class UsageOut(BaseModel):
    """What a key has now, and used in the last 24 hours."""

    jobs: int
    bytes: int
    samples: int


class KeyOut(BaseModel):
    """A key, without its secret."""

    id: str
    name: str
    scope: Scope
    quota: QuotaIn
    created_at: str
    usage: UsageOut


class NewKeyOut(KeyOut):
    """A key with its secret, which is told only once."""

    key: str


class KeysOut(BaseModel):
    """All keys, oldest first."""

    keys: list[KeyOut]


@router.post("/v1/keys", summary="Make an API key", status_code=201, responses=problem_responses(404))
async def create_key(body: KeyIn, farm: Farm) -> NewKeyOut:
    """Make a key. Its secret is in this reply and nowhere else: the service keeps a digest of it."""
    key, secret = await _ring(farm).add(body.name, Scope(body.scope), Quota(**body.quota.model_dump()))
    return NewKeyOut(**(await _out(farm, key)).model_dump(), key=secret)


@router.get("/v1/keys", summary="List API keys", responses=problem_responses(404))
async def list_keys(farm: Farm) -> KeysOut:
    """All keys with what they used."""
    return KeysOut(keys=[await _out(farm, key) for key in _ring(farm).all()])


@router.delete("/v1/keys/{key_id}", summary="Drop an API key", status_code=204, responses=problem_responses(404))
async def drop_key(key_id: KeyId, farm: Farm) -> None:
    """Drop a key: requests with it are answered 401 from now on. Its jobs stay."""
    await _ring(farm).drop(key_id)


def _ring(farm: Services) -> KeyRing:
    if farm.keys is None:
        raise NotFound("/v1/keys: this service asks nobody for keys; start it with FLUXFARM_KEYS=on")
    return farm.keys


async def _out(farm: Services, key: ApiKey) -> KeyOut:
    jobs, used = await farm.ledger.usage(key.id)
    return KeyOut(
        id=key.id,
        name=key.name,
        scope=key.scope,
        quota=QuotaIn(jobs=key.quota.jobs, bytes_a_day=key.quota.bytes_a_day, samples_a_day=key.quota.samples_a_day),
        created_at=iso_time(key.created_at),
        usage=UsageOut(jobs=jobs, bytes=sum(hour.bytes for hour in used), samples=sum(hour.samples for hour in used)),
    )
