"""Everything that the service refuses or cannot do.

    FarmError                     500 internal
    +-- BadRequest                422 malformed-request
    |   +-- BadBundle             422 bad-bundle
    |   +-- DigestMismatch        422 digest-mismatch
    |   +-- UnknownBuiltin        422 unknown-builtin
    +-- NotFound                  404 not-found
    |   +-- JobNotFound           404 job-not-found
    |   +-- NotYetThere           404 not-yet-there
    |   +-- TileOutsideFrame      404 tile-outside-frame
    +-- Gone                      410 gone
    +-- Conflict                  409 conflict
    |   +-- IllegalTransition     409 illegal-transition
    |   +-- AssetsMissing         409 assets-missing
    |   +-- IdempotencyConflict   409 idempotency-conflict
    |   +-- StaleLease            409 stale-lease
    +-- TooLarge                  413 too-large
    +-- Unauthorized              401 unauthorized
    +-- Forbidden                 403 forbidden
    +-- QuotaExceeded             429 quota-exceeded
    +-- EngineTrouble             503 engine-trouble
    +-- DiskFull                  507 disk-full
    +-- ChartError                (ends `fluxfarm chart`)
    +-- StartError                (ends the program before it serves)
        +-- DataFolderInUse
        +-- StoreDamaged
        +-- StoreUnusable
        +-- SchemaTooNew
        +-- BadSetting
        +-- EngineMissing

Thrown low, caught once: `api/problems.py` turns a FarmError into an HTTP problem reply.
"""

import math
from typing import Any, ClassVar


class FarmError(Exception):
    """Base of all; its text says what, where, value and what would be right."""

    status: ClassVar[int] = 500
    code: ClassVar[str] = "internal"

    def extra(self) -> dict[str, Any]:
        """Further members of the problem reply."""
        return {}

    def headers(self) -> dict[str, str]:
        """Headers of the problem reply."""
        return {}


class BadRequest(FarmError):
    """The request itself is malformed: sending it again cannot work. `field` names the place in it."""

    status = 422
    code = "malformed-request"

    def __init__(self, field: str, value: object, expected: str) -> None:
        self.field = field
        super().__init__(f"{field} = {shortened(value)}: {expected}")

    def extra(self) -> dict[str, Any]:
        return {"field": self.field}


class BadBundle(BadRequest):
    """A path, digest or entry of the scene's bundle is not usable."""

    code = "bad-bundle"


class DigestMismatch(BadRequest):
    """The bytes sent are not the ones that the digest in the address names."""

    code = "digest-mismatch"


class UnknownBuiltin(BadRequest):
    """No scene of that name comes with the service."""

    code = "unknown-builtin"


class NotFound(FarmError):
    """Nothing has that address."""

    status = 404
    code = "not-found"


class JobNotFound(NotFound):
    """No job has that id."""

    code = "job-not-found"


class NotYetThere(NotFound):
    """The job exists, but has not produced this yet."""

    code = "not-yet-there"


class TileOutsideFrame(NotFound):
    """The job's grid has no tile at that column and row."""

    code = "tile-outside-frame"


class Gone(FarmError):
    """The job existed and was deleted."""

    status = 410
    code = "gone"


class Conflict(FarmError):
    """The request is fine, but not in the present state."""

    status = 409
    code = "conflict"


class IllegalTransition(Conflict):
    """The job's state does not allow this."""

    code = "illegal-transition"


class AssetsMissing(Conflict):
    """The bundle names files that were never uploaded; `missing` maps their paths to their digests."""

    code = "assets-missing"

    def __init__(self, missing: dict[str, str]) -> None:
        self.missing = missing
        first, sha256 = next(iter(missing.items()))
        super().__init__(
            f"{len(missing)} file(s) of the scene are not stored, the first is {first!r} with digest {sha256}; "
            "upload them with PUT /v1/assets/{sha256} and send the job again"
        )

    def extra(self) -> dict[str, Any]:
        return {"missing": self.missing}


class IdempotencyConflict(Conflict):
    """The Idempotency-Key was used before with another body."""

    code = "idempotency-conflict"


class StaleLease(Conflict):
    """The lease was revoked meanwhile; what it brings is dropped."""

    code = "stale-lease"


class TooLarge(FarmError):
    """The body is longer than the service accepts."""

    status = 413
    code = "too-large"


class Unauthorized(FarmError):
    """The request carries no key that this service knows."""

    status = 401
    code = "unauthorized"

    def headers(self) -> dict[str, str]:
        return {"WWW-Authenticate": 'Bearer realm="fluxfarm"'}


class Forbidden(FarmError):
    """The key of the request does not allow this."""

    status = 403
    code = "forbidden"


class QuotaExceeded(FarmError):
    """The key has used what it may; `retry_after_s` is when it is worth to ask again."""

    status = 429
    code = "quota-exceeded"

    def __init__(self, message: str, retry_after_s: float) -> None:
        self.retry_after_s = retry_after_s
        super().__init__(message)

    def headers(self) -> dict[str, str]:
        return {"Retry-After": str(math.ceil(self.retry_after_s))}


class EngineTrouble(FarmError):
    """An engine process could not carry out what the reply needs."""

    status = 503
    code = "engine-trouble"


class DiskFull(FarmError):
    """There is no room for an upload."""

    status = 507
    code = "disk-full"


class ChartError(FarmError):
    """`fluxfarm chart` cannot measure this; the text says what to mend."""

    code = "chart"


class StartError(FarmError):
    """The service cannot start; the text says what to do about it."""

    code = "start"


class DataFolderInUse(StartError):
    """Another service works in the same data folder."""


class StoreDamaged(StartError):
    """The database does not pass SQLite's check, or names files that are not there."""


class StoreUnusable(StartError):
    """The database cannot be opened for writing, or another program holds it."""


class SchemaTooNew(StartError):
    """The database was written by a newer service."""


class BadSetting(StartError):
    """A FLUXFARM_ variable of the environment has a value that means nothing."""


class EngineMissing(StartError):
    """No engine program was found."""


def shortened(value: object, length: int = 120) -> str:
    """`value` as it would be written in Python, cut to `length` characters, for use in a message."""
    text = repr(value)
    return text if len(text) <= length else text[: length - 3] + "..."
