"""Where the error of a job is expected to end, as told on the way by one of its revisions."""

from collections.abc import Sequence

from fluxfarm.domain.goal import ceiling_spp, settled
from fluxfarm.domain.job import TERMINAL_STATES
from fluxfarm.domain.progress import eta_seconds
from fluxfarm.domain.records import JobRecord, Revision

# A job that has ended is shown with what it foretold after this share of its samples.
FORETOLD_SHARE = 0.2


def predicted_path(record: JobRecord, revisions: Sequence[Revision]) -> list[tuple[float, float]]:
    """(seconds in RUNNING, relative error) of the revision that foretells and of the predicted end; [] if none can.

    The newest revision foretells while the job goes on; of a job that has ended, the first with a fifth of its samples,
    so that what came can be compared. The error falls with the square root of the time, as noise does; how long it has
    to fall, the goal says, for an error goal by what the engine expected at its last decision.
    """
    if record.facts is None or record.grid is None:
        return []
    known = [revision for revision in revisions if revision.error_noise and revision.running_s > 0]
    if not known:
        return []
    foretelling = known[-1]
    if record.state in TERMINAL_STATES:
        least = FORETOLD_SHARE * known[-1].mean_samples
        foretelling = next(revision for revision in known if revision.mean_samples >= least)
    goal = settled(record.request.goal, record.facts.scene_spp)
    decided = [r.samples_expected for r in revisions if r.number <= foretelling.number and r.samples_expected]
    expected_spp = decided[-1] / record.grid.crop.area if decided else None
    error, seconds = foretelling.error_noise, foretelling.running_s
    ceiling = ceiling_spp(goal, record.request.limits)
    left = eta_seconds(goal, foretelling.mean_samples, seconds, error, ceiling, expected_spp)
    if not left or not error:
        return []
    end = seconds + left
    return [(seconds, error), (end, error * (seconds / end) ** 0.5)]
