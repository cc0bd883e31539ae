"""Changes of the ledger that belong to API keys: the keys, what they used, and their quotas.

Each is a function that works inside one transaction. A job's quota is looked at in that which records the job, so that
two at once cannot both be the last; uploads at once may each take the bytes that are left.
"""

import time

from sqlalchemy import Connection, delete, func, insert, select
from sqlalchemy.dialects.sqlite import insert as upsert

from fluxfarm.adapters.ledger import rows
from fluxfarm.adapters.ledger.schema import api_keys, jobs, key_usage
from fluxfarm.domain.access import DAY_S, ApiKey, Usage, seconds_until_below
from fluxfarm.domain.job import TERMINAL_STATES
from fluxfarm.errors import QuotaExceeded

HOUR_S = 3600
# How long a job takes to end nobody knows.
RETRY_JOBS_S = 30


def add_key(connection: Connection, key: ApiKey, sha256: str) -> None:
    """Keep a new key, by the digest of its secret."""
    connection.execute(insert(api_keys).values(rows.key_to_row(key, sha256)))


def drop_key(connection: Connection, key_id: str) -> bool:
    """Forget a key; its jobs stay. False if there is none."""
    return connection.execute(delete(api_keys).where(api_keys.c.id == key_id)).rowcount == 1


def note_usage(connection: Connection, key_id: str, sent_bytes: int, samples: int) -> None:
    """Count what a key used now, and forget what is older than a day."""
    hour = int(time.time()) // HOUR_S
    row = upsert(key_usage).values(key_id=key_id, hour=hour, bytes=sent_bytes, samples=samples)
    added = {"bytes": key_usage.c.bytes + sent_bytes, "samples": key_usage.c.samples + samples}
    connection.execute(row.on_conflict_do_update(index_elements=["key_id", "hour"], set_=added))
    connection.execute(delete(key_usage).where(key_usage.c.key_id == key_id, key_usage.c.hour < _first_hour()))


def usage(connection: Connection, key_id: str) -> list[Usage]:
    """What a key used in the last 24 hours, the oldest hour first."""
    query = (
        select(key_usage.c.hour, key_usage.c.bytes, key_usage.c.samples)
        .where(key_usage.c.key_id == key_id, key_usage.c.hour >= _first_hour())
        .order_by(key_usage.c.hour)
    )
    return [Usage(row.hour, row.bytes, row.samples) for row in connection.execute(query)]


def unfinished_jobs(connection: Connection, key_id: str) -> int:
    """How many jobs of a key have not ended."""
    query = select(func.count()).where(jobs.c.owner == key_id, jobs.c.state.not_in(list(TERMINAL_STATES)))
    return int(connection.execute(query).scalar_one())


def check_job(connection: Connection, key: ApiKey, samples: int) -> None:
    """Raise QuotaExceeded unless `key` may have one more job, known to take so many camera samples (0: not known)."""
    unfinished = unfinished_jobs(connection, key.id)
    if key.quota.jobs is not None and unfinished >= key.quota.jobs:
        raise QuotaExceeded(
            f"key {key.name!r}: has {unfinished} unfinished job(s), expected fewer than {key.quota.jobs}; "
            "wait for one to end or cancel it",
            RETRY_JOBS_S,
        )
    used = [(hour.hour, hour.samples) for hour in usage(connection, key.id)]
    _check_day(key, "camera samples", used, samples, key.quota.samples_a_day)


def bytes_left(connection: Connection, key: ApiKey) -> int | None:
    """How much `key` may still upload (None: any); raises QuotaExceeded if nothing."""
    if key.quota.bytes_a_day is None:
        return None
    used = [(hour.hour, hour.bytes) for hour in usage(connection, key.id)]
    _check_day(key, "uploaded bytes", used, 0, key.quota.bytes_a_day)
    return key.quota.bytes_a_day - sum(amount for _, amount in used)


def _check_day(key: ApiKey, noun: str, used: list[tuple[int, int]], wanted: int, most: int | None) -> None:
    total = sum(amount for _, amount in used)
    if most is None or (total < most and total + wanted <= most):
        return
    more = f" and asks for {wanted}" if wanted else ""
    raise QuotaExceeded(
        f"key {key.name!r}: used {total} {noun} in 24 hours{more}, expected at most {most}",
        seconds_until_below(used, most - wanted, time.time()),
    )


def _first_hour() -> int:
    """The oldest hour that counts to the day."""
    return (int(time.time()) - DAY_S) // HOUR_S
