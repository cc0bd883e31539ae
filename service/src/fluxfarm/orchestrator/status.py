"""How far a job is: what the ledger counts, plus what engine processes report beyond it."""

from fluxfarm.domain.goal import ceiling_spp, settled
from fluxfarm.domain.job import TERMINAL_STATES, JobState
from fluxfarm.domain.progress import Progress, eta_seconds
from fluxfarm.domain.records import JobRecord
from fluxfarm.domain.schedule import pass_count
from fluxfarm.orchestrator.run import JobRun


def progress_of(record: JobRecord, run: JobRun | None, now: float) -> Progress:
    """Progress of a job; `run` is None if it is not being worked on, `now` is the run's clock in seconds."""
    if record.grid is None or record.facts is None:
        return Progress(0, 0, 0, 0, None, None)
    goal = settled(record.request.goal, record.facts.scene_spp)
    ceiling = ceiling_spp(goal, record.request.limits)
    samples = record.samples_done + (0 if run is None else run.samples_in_flight())
    running_s = record.running_s if run is None else run.running_s(now)
    error = None if record.newest is None else record.newest.error_noise
    if goal.rel_error is not None:
        tiles = record.tiles_done + (0 if run is None else run.tiles_left())
    elif goal.spp is not None and record.state not in TERMINAL_STATES:
        tiles = record.grid.count * max(record.passes_opened, pass_count(ceiling or goal.spp))
    else:
        tiles = record.grid.count * record.passes_opened
    eta = None
    if record.state in (JobState.RUNNING, JobState.FINALIZING):
        pixels, expected = record.grid.crop.area, None if run is None else run.samples_expected
        expected_spp = None if expected is None else expected / pixels
        eta = eta_seconds(goal, samples / pixels, running_s, error, ceiling, expected_spp)
    return Progress(record.tiles_done, tiles, samples, record.passes_opened, error, eta)
