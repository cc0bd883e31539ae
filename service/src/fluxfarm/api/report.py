"""What a job did: its plan, its report and its chart."""

import math
from typing import Any

from fastapi import APIRouter, Response
from pydantic import BaseModel, Field

from fluxfarm.api.deps import Farm, JobId, Services
from fluxfarm.api.problems import problem_responses
from fluxfarm.api.schemas import RevisionOut, revision_out
from fluxfarm.domain.events import Event, EventKind
from fluxfarm.domain.job import JobState
from fluxfarm.domain.records import JobRecord, Revision
from fluxfarm.errors import NotYetThere

router = APIRouter(tags=["reports"])
WIDTH, HEIGHT, MARGIN = 640, 400, 56


class PointOut(BaseModel):
    """One revision on the way to the goal."""

    seconds: float = Field(description="Time in RUNNING.")
    spp: float = Field(description="Samples per pixel, mean over the picture.")
    error: float | None = Field(description="Estimated relative error from the noise.")


class ReportOut(BaseModel):
    """What a job did so far."""

    id: str
    state: JobState
    integrator: str | None
    goal: dict[str, int | float | None]
    samples: int = Field(description="Camera samples, over all pixels.")
    rays: int
    rays_per_second: float | None
    non_finite_samples: int
    seconds: dict[str, float] = Field(description="Wall time in each state, by its name.")
    error: dict[str, float | None]
    timeline: list[PointOut]
    revisions: list[RevisionOut]
    plan: dict[str, Any] | None
    warnings: list[str]


@router.get("/v1/jobs/{job_id}/plan", summary="Plan of a job", responses=problem_responses(404, 410))
async def plan(job_id: JobId, farm: Farm) -> dict[str, Any]:
    """What the scene contains, and which methods and parts of the engine it switches on or off."""
    record = await farm.ledger.job(job_id)
    if record.facts is None:
        raise NotYetThere(f"job {job_id}: state {record.state}; the plan is there once the scene is prepared")
    return record.facts.plan


@router.get("/v1/jobs/{job_id}/report", summary="Report of a job", responses=problem_responses(404, 410))
async def report(job_id: JobId, farm: Farm) -> ReportOut:
    """Goal, samples, time by state, the error over time, warnings."""
    record = await farm.ledger.job(job_id)
    revisions = await farm.ledger.revisions(job_id)
    running_s = farm.orchestrator.running_s(record)
    goal = record.request.goal
    return ReportOut(
        id=record.id,
        state=record.state,
        integrator=None if record.facts is None else record.facts.integrator,
        goal={"rel_error": goal.rel_error, "spp": goal.spp, "seconds": goal.seconds},
        samples=record.samples_done,
        rays=record.rays,
        rays_per_second=record.rays / running_s if running_s > 0 else None,
        non_finite_samples=record.non_finite_samples,
        seconds=await _seconds_by_state(farm, record),
        # Path tracing has no bias of its own.
        error={
            "noise": None if record.newest is None else record.newest.error_noise,
            "bias": 0.0,
            "unseen": None if record.newest is None else record.newest.error_unseen,
        },
        timeline=[PointOut(seconds=r.running_s, spp=r.mean_samples, error=r.error_noise) for r in revisions],
        revisions=[revision_out(revision) for revision in revisions],
        plan=None if record.facts is None else record.facts.plan,
        warnings=list(record.warnings),
    )


@router.get(
    "/v1/jobs/{job_id}/chart.svg",
    summary="Error over time",
    responses=problem_responses(404, 410, also={200: {"content": {"image/svg+xml": {}}}}),
    response_class=Response,
)
async def chart(job_id: JobId, farm: Farm) -> Response:
    """The estimated relative error over the time in RUNNING, both axes logarithmic."""
    await farm.ledger.job(job_id)
    points = chart_points(await farm.ledger.revisions(job_id))
    if len(points) < 2:
        raise NotYetThere(f"job {job_id}: {len(points)} revision(s) with an error, a chart needs two")
    return Response(draw(points), media_type="image/svg+xml")


def chart_points(revisions: list[Revision]) -> list[tuple[float, float]]:
    """(seconds, error) of the revisions that have a positive error."""
    return [(r.running_s, r.error_noise) for r in revisions if r.error_noise and r.running_s > 0]


def draw(points: list[tuple[float, float]]) -> str:
    """An SVG of the points, with a grid line at each power of ten."""
    x_low, x_high = _decades([x for x, _ in points])
    y_low, y_high = _decades([y for _, y in points])

    def place(x: float, y: float) -> tuple[float, float]:
        across = (math.log10(x) - x_low) / (x_high - x_low)
        up = (math.log10(y) - y_low) / (y_high - y_low)
        return MARGIN + across * (WIDTH - 2 * MARGIN), HEIGHT - MARGIN - up * (HEIGHT - 2 * MARGIN)

    box = f'viewBox="0 0 {WIDTH} {HEIGHT}"'
    parts = [f'<svg xmlns="http://www.w3.org/2000/svg" {box} font-family="sans-serif" font-size="11">']
    parts.append(f'<rect width="{WIDTH}" height="{HEIGHT}" fill="white"/>')
    for power in range(x_low, x_high + 1):
        x, _ = place(10.0**power, 10.0**y_low)
        parts.append(f'<path d="M{x:.1f} {MARGIN}V{HEIGHT - MARGIN}" stroke="#ddd"/>')
        parts.append(f'<text x="{x:.1f}" y="{HEIGHT - MARGIN + 16}" text-anchor="middle">{10.0**power:g}</text>')
    for power in range(y_low, y_high + 1):
        _, y = place(10.0**x_low, 10.0**power)
        parts.append(f'<path d="M{MARGIN} {y:.1f}H{WIDTH - MARGIN}" stroke="#ddd"/>')
        parts.append(f'<text x="{MARGIN - 6}" y="{y + 4:.1f}" text-anchor="end">{10.0**power:g}</text>')
    line = " ".join(f"{x:.1f},{y:.1f}" for x, y in (place(*point) for point in points))
    parts.append(f'<polyline points="{line}" fill="none" stroke="#06c" stroke-width="2"/>')
    for point in points:
        x, y = place(*point)
        parts.append(f'<circle cx="{x:.1f}" cy="{y:.1f}" r="3" fill="#06c"/>')
    parts.append(f'<text x="{WIDTH / 2}" y="{HEIGHT - 12}" text-anchor="middle">time in RUNNING, seconds</text>')
    parts.append(f'<text x="{MARGIN}" y="{MARGIN - 16}">estimated relative error (noise)</text></svg>')
    return "\n".join(parts)


def _decades(values: list[float]) -> tuple[int, int]:
    """Whole powers of ten around the values, at least one apart."""
    low = math.floor(math.log10(min(values)))
    return low, max(low + 1, math.ceil(math.log10(max(values))))


async def _seconds_by_state(farm: Services, record: JobRecord) -> dict[str, float]:
    """Wall time in each state, from the state events; a state that lasts is counted up to the last event."""
    seconds: dict[str, float] = {}
    last: Event | None = None
    after, now = 0, record.created_at
    while page := await farm.ledger.events_after(record.id, after, 5000):
        after, now = page[-1].seq, page[-1].at
        for event in page:
            if event.kind is EventKind.STATE:
                if last is not None:
                    name = str(last.data["state"])
                    seconds[name] = seconds.get(name, 0.0) + event.at - last.at
                last = event
    if last is not None and record.state == last.data["state"]:
        seconds[record.state] = seconds.get(record.state, 0.0) + now - last.at
    return {name: round(value, 6) for name, value in seconds.items()}
