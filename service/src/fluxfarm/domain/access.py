"""Who may do what, and how much of it: API keys, their scopes and quotas."""

from dataclasses import dataclass
from enum import StrEnum

DAY_S = 24 * 3600


class Scope(StrEnum):
    """What a key allows; each contains those before it."""

    READ = "read"
    SUBMIT = "submit"
    ADMIN = "admin"

    def allows(self, other: "Scope") -> bool:
        """Whether a key of this scope may do what asks for `other`."""
        order = list(Scope)
        return order.index(self) >= order.index(other)


@dataclass(frozen=True, slots=True)
class Quota:
    """The most that a key may have: unfinished jobs at once, bytes and camera samples in 24 hours. None: any."""

    jobs: int | None = None
    bytes_a_day: int | None = None
    samples_a_day: int | None = None


@dataclass(frozen=True, slots=True)
class ApiKey:
    """A key as it is kept, without the secret."""

    id: str
    name: str
    scope: Scope
    quota: Quota
    created_at: float


@dataclass(frozen=True, slots=True)
class Usage:
    """What a key used in one hour; `hour` counts them from the beginning of Unix time."""

    hour: int
    bytes: int
    samples: int


def seconds_until_below(used: list[tuple[int, int]], most: int, now_s: float) -> float:
    """Seconds until amounts, given as (hour, amount) with the oldest first, have left the day so far that less than
    `most` is used; the hour that `now_s` is in counts to its end. With `most` 0 that is when all have left it."""
    left = sum(amount for _, amount in used)
    for hour, amount in used:
        left -= amount
        if left < max(most, 1):
            return max((hour + 1) * 3600 + DAY_S - now_s, 1.0)
    return 1.0
