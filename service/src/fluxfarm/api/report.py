"""What a job did: its plan, its report and its chart."""

from typing import Any

from fastapi import APIRouter, Response
from pydantic import BaseModel, Field

from fluxfarm.api.deps import Farm, JobId, Services
from fluxfarm.api.problems import problem_responses
from fluxfarm.api.schemas import RevisionOut, revision_out
from fluxfarm.domain.events import Event, EventKind
from fluxfarm.domain.job import JobState
from fluxfarm.domain.prediction import predicted_path
from fluxfarm.domain.records import JobRecord, Revision
from fluxfarm.errors import NotYetThere
from fluxfarm.plot import Curve, Panel, draw

router = APIRouter(tags=["reports"])


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
        error={
            "noise": None if record.newest is None else record.newest.error_noise,
            "bias": None if record.newest is None else record.newest.error_bias,
            # Only what was merged at the end of a round was looked at.
            "unseen": next((r.error_unseen for r in reversed(revisions) if r.error_unseen is not None), None),
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
    """The estimated relative error over the time in RUNNING, both axes logarithmic; dashed, the end that was
    predicted (of a job that goes on by its newest revision, else by the first with a fifth of its samples); dotted, an
    error goal."""
    record = await farm.ledger.job(job_id)
    revisions = await farm.ledger.revisions(job_id)
    points = chart_points(revisions)
    if len(points) < 2:
        raise NotYetThere(f"job {job_id}: {len(points)} revision(s) with an error, a chart needs two")
    curves = job_curves(points, predicted_path(record, revisions), record.request.goal.rel_error)
    svg = draw([Panel(curves, "time in RUNNING, seconds", "estimated relative error (noise)")])
    return Response(svg, media_type="image/svg+xml")


def job_curves(
    points: list[tuple[float, float]], predicted: list[tuple[float, float]], rel_error: float | None
) -> list[Curve]:
    """The job's own curve, its prediction if there is one, and its error goal if it has one."""
    curves = [Curve(points, "this job")]
    if predicted:
        (start, _), (end, error) = predicted
        name = f"predicted at {start:.3g} s: error {error:.2g} after {end:.3g} s"
        curves.append(Curve(predicted, name, "#c40", "6 4", dots=False, diamonds=predicted[1:]))
    if rel_error is not None:
        seconds = [x for curve in curves for x, _ in curve.points]
        goal = [(min(seconds), rel_error), (max(seconds), rel_error)]
        curves.append(Curve(goal, f"goal: error {rel_error:g}", "#555", "2 4", dots=False))
    return curves


def chart_points(revisions: list[Revision]) -> list[tuple[float, float]]:
    """(seconds, error) of the revisions that have a positive error."""
    return [(r.running_s, r.error_noise) for r in revisions if r.error_noise and r.running_s > 0]


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
