"""The API keys of a service: made here, told once, kept as digests, found again by what a request carries."""

import hashlib
import secrets
import time
import uuid

from fluxfarm.domain.access import ApiKey, Quota, Scope
from fluxfarm.errors import Forbidden, NotFound
from fluxfarm.ports import Ledger

# So that a key is known for one where it was left by mistake.
PREFIX = "fluxfarm_"
SECRET_BYTES = 32
# Id and name of the key of who runs the service.
OWNER = "owner"


def digest(secret: str) -> str:
    """What is kept of a secret. It is random and long, so that a plain hash cannot be reversed."""
    return hashlib.sha256(secret.encode()).hexdigest()


def new_secret() -> str:
    """What a request carries to be known."""
    return PREFIX + secrets.token_urlsafe(SECRET_BYTES)


class KeyRing:
    """All keys, in memory and in the ledger."""

    def __init__(self, ledger: Ledger) -> None:
        self._ledger = ledger
        self._by_sha256: dict[str, ApiKey] = {}

    async def load(self) -> None:
        """Read the keys; once, before the first question."""
        self._by_sha256 = await self._ledger.keys()

    def find(self, secret: str) -> ApiKey | None:
        """The key with this secret."""
        return self._by_sha256.get(digest(secret))

    def all(self) -> list[ApiKey]:
        """All keys, oldest first."""
        return list(self._by_sha256.values())

    async def add(self, name: str, scope: Scope, quota: Quota) -> tuple[ApiKey, str]:
        """A new key and its secret, which is told only here."""
        secret = new_secret()
        key = ApiKey(uuid.uuid4().hex[:12], name, scope, quota, time.time())
        await self._keep(key, secret)
        return key, secret

    async def renew_owner(self, secret: str) -> None:
        """Give the owner of the machine, who may do everything, another key."""
        await self._forget(OWNER)
        await self._keep(ApiKey(OWNER, OWNER, Scope.ADMIN, Quota(), time.time()), secret)

    async def drop(self, key_id: str) -> None:
        """Forget a key: it opens nothing any more. Raises NotFound, and Forbidden for that of the machine's owner."""
        if key_id == OWNER:
            raise Forbidden(
                f"key {OWNER}: is that of the machine's owner; to renew it, remove its file in the data folder and "
                "start the service again"
            )
        if not await self._forget(key_id):
            raise NotFound(f"key {key_id}: not found; expected the id of one of GET /v1/keys")

    async def _keep(self, key: ApiKey, secret: str) -> None:
        await self._ledger.add_key(key, digest(secret))
        self._by_sha256[digest(secret)] = key

    async def _forget(self, key_id: str) -> bool:
        found = await self._ledger.drop_key(key_id)
        self._by_sha256 = {sha256: key for sha256, key in self._by_sha256.items() if key.id != key_id}
        return found
