"""A job's states and the transitions between them, as one table.

Every change of state in the service goes through `check_transition`; nothing else decides what may follow what.
"""

from enum import StrEnum

from fluxfarm.errors import IllegalTransition


class JobState(StrEnum):
    """Where a job is in its life. `STATE_SENTENCES` says what each state means to its owner."""

    QUEUED = "QUEUED"
    PREPARING = "PREPARING"
    RUNNING = "RUNNING"
    FINALIZING = "FINALIZING"
    PAUSED = "PAUSED"
    SUCCEEDED = "SUCCEEDED"
    FAILED = "FAILED"
    CANCELLED = "CANCELLED"


STATE_SENTENCES: dict[JobState, str] = {
    JobState.QUEUED: "The job is stored and waits for an engine process.",
    JobState.PREPARING: "An engine process reads and compiles the scene.",
    JobState.RUNNING: "Tiles are being rendered; every finished pass publishes a revision.",
    JobState.FINALIZING: "All samples are taken; the last revision is being written.",
    JobState.PAUSED: "The owner stopped the job for now, or it waits for room on the disk and goes on by itself; "
    "`reason` says so. What was committed is kept.",
    JobState.SUCCEEDED: "The goal or a limit was reached; the newest revision is the result.",
    JobState.FAILED: "The job cannot go on; `reason` says why. Revisions published before stay.",
    JobState.CANCELLED: "The owner gave the job up; no tile is committed any more. Revisions published before stay.",
}

TRANSITIONS: dict[JobState, frozenset[JobState]] = {
    JobState.QUEUED: frozenset({JobState.PREPARING, JobState.PAUSED, JobState.CANCELLED, JobState.FAILED}),
    # Back to QUEUED when the service restarts or the engine process is lost.
    JobState.PREPARING: frozenset(
        {JobState.RUNNING, JobState.QUEUED, JobState.PAUSED, JobState.CANCELLED, JobState.FAILED}
    ),
    JobState.RUNNING: frozenset({JobState.FINALIZING, JobState.PAUSED, JobState.CANCELLED, JobState.FAILED}),
    # Back to RUNNING when the service restarts before the last revision is recorded.
    JobState.FINALIZING: frozenset({JobState.SUCCEEDED, JobState.RUNNING, JobState.CANCELLED, JobState.FAILED}),
    # To RUNNING when the scene was prepared before the pause, else to QUEUED.
    JobState.PAUSED: frozenset({JobState.QUEUED, JobState.RUNNING, JobState.CANCELLED}),
    JobState.SUCCEEDED: frozenset(),
    JobState.FAILED: frozenset(),
    JobState.CANCELLED: frozenset(),
}

TERMINAL_STATES: frozenset[JobState] = frozenset(state for state, following in TRANSITIONS.items() if not following)


def check_transition(job_id: str, current: JobState, wanted: JobState) -> None:
    """Return if a job in `current` may go to `wanted`; else raise IllegalTransition naming what is possible."""
    if wanted in TRANSITIONS[current]:
        return
    possible = ", ".join(sorted(TRANSITIONS[current])) or "nothing: the state is final"
    raise IllegalTransition(f"job {job_id}: state {current} cannot become {wanted}; possible from here: {possible}")
