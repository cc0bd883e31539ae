"""Rows of the ledger to values of the ports, and back."""

import json
from dataclasses import asdict
from typing import Any

from sqlalchemy import Row

from fluxfarm.domain.access import ApiKey, Quota, Scope
from fluxfarm.domain.events import Event, EventKind
from fluxfarm.domain.goal import Goal, Limits
from fluxfarm.domain.job import JobState
from fluxfarm.domain.records import JobRecord, JobRequest, OpenedPass, Revision, SceneFacts
from fluxfarm.domain.scene import SceneBundle
from fluxfarm.domain.schedule import Round, SampleRange
from fluxfarm.domain.tiles import PixelRect, TileGrid


def to_json(value: object) -> str:
    """Compact JSON, keys in order."""
    return json.dumps(value, separators=(",", ":"), sort_keys=True)


def request_to_json(request: JobRequest) -> str:
    """A request as one JSON text."""
    return to_json(asdict(request))


def request_from_json(text: str) -> JobRequest:
    """The inverse of `request_to_json`."""
    raw = json.loads(text)
    raw["bundle"] = SceneBundle(**raw["bundle"])
    raw["size"] = tuple(raw["size"]) if raw["size"] else None
    raw["crop"] = PixelRect(**raw["crop"]) if raw["crop"] else None
    raw["goal"] = Goal(**raw["goal"])
    raw["limits"] = Limits(**raw["limits"])
    return JobRequest(**raw)


def facts_to_json(facts: SceneFacts) -> str:
    """What the engine found, as one JSON text."""
    return to_json(asdict(facts))


def facts_from_json(text: str) -> SceneFacts:
    """The inverse of `facts_to_json`."""
    raw = json.loads(text)
    raw["crop"] = PixelRect(**raw["crop"])
    raw["warnings"] = tuple(raw["warnings"])
    return SceneFacts(**raw)


def revision_from_row(row: Row[Any]) -> Revision:
    """A row of `revisions`."""
    raw = dict(row._mapping)
    del raw["job_id"]
    raw["mean"] = (raw.pop("mean_r"), raw.pop("mean_g"), raw.pop("mean_b"))
    raw["next_round"] = None if raw["next_round"] is None else _round_from_json(raw["next_round"])
    return Revision(**raw)


def revision_to_row(job_id: str, revision: Revision) -> dict[str, Any]:
    """The inverse of `revision_from_row`."""
    raw = asdict(revision)
    raw["mean_r"], raw["mean_g"], raw["mean_b"] = raw.pop("mean")
    raw["next_round"] = None if raw["next_round"] is None else to_json(raw["next_round"])
    return raw | {"job_id": job_id}


def _round_from_json(text: str) -> Round:
    raw = json.loads(text)
    return Round(raw["number"], SampleRange(**raw["samples"]), None if raw["tiles"] is None else tuple(raw["tiles"]))


def pass_from_row(row: Row[Any]) -> OpenedPass:
    """A row of `passes`."""
    tiles = None if row.tiles is None else tuple(json.loads(row.tiles))
    return OpenedPass(row.pass_index, SampleRange(row.sample_begin, row.sample_end), tiles)


def pass_to_row(job_id: str, opened: OpenedPass) -> dict[str, Any]:
    """The inverse of `pass_from_row`."""
    return {
        "job_id": job_id,
        "pass_index": opened.index,
        "sample_begin": opened.samples.begin,
        "sample_end": opened.samples.end,
        "tiles": None if opened.tiles is None else to_json(opened.tiles),
    }


def event_from_row(row: Row[Any]) -> Event:
    """A row of `events`."""
    return Event(row.seq, EventKind(row.kind), row.at, json.loads(row.data))


def key_from_row(row: Row[Any]) -> ApiKey:
    """A row of `api_keys`."""
    quota = Quota(row.quota_jobs, row.quota_bytes, row.quota_samples)
    return ApiKey(row.id, row.name, Scope(row.scope), quota, row.created_at)


def key_to_row(key: ApiKey, sha256: str) -> dict[str, Any]:
    """The inverse of `key_from_row`; `sha256` is that of the secret."""
    return {
        "id": key.id,
        "sha256": sha256,
        "name": key.name,
        "scope": key.scope,
        "quota_jobs": key.quota.jobs,
        "quota_bytes": key.quota.bytes_a_day,
        "quota_samples": key.quota.samples_a_day,
        "created_at": key.created_at,
    }


def job_from_row(row: Row[Any], newest: Revision | None) -> JobRecord:
    """A row of `jobs`, with its newest revision."""
    facts = None if row.facts is None else facts_from_json(row.facts)
    return JobRecord(
        id=row.id,
        state=JobState(row.state),
        reason=row.reason,
        request=request_from_json(row.request),
        created_at=row.created_at,
        owner=row.owner,
        facts=facts,
        grid=None if facts is None else TileGrid(facts.crop, row.tile_size),
        warnings=tuple(json.loads(row.warnings)),
        tiles_done=row.tiles_done,
        samples_done=row.samples_done,
        rays=row.rays,
        non_finite_samples=row.non_finite_samples,
        passes_opened=row.passes_opened,
        running_s=row.running_s,
        crashes=row.crashes,
        resource_failures=row.resource_failures,
        newest=newest,
    )
