"""The progress bar. Imported only where there is a terminal."""

from typing import Any, TextIO

from rich.console import Console
from rich.progress import BarColumn, Progress, SpinnerColumn, TextColumn, TimeElapsedColumn

from fluxfarm.cli.follow import describe


class Bar:
    """A bar that fills with the share of the work that is done, as far as that can be told."""

    def __init__(self, out: TextIO) -> None:
        self._console = Console(file=out)
        self._progress = Progress(
            SpinnerColumn(), BarColumn(), TextColumn("{task.description}"), TimeElapsedColumn(), console=self._console
        )
        self._task = self._progress.add_task("waiting", total=None)
        self._warnings = 0

    def __enter__(self) -> "Bar":
        self._progress.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._progress.stop()

    def show(self, job: dict[str, Any]) -> None:
        """Draw the job as it is now."""
        for warning in job["warnings"][self._warnings :]:
            self._console.print(f"warning: {warning}", markup=False, highlight=False)
        self._warnings = len(job["warnings"])
        share = done_share(job, self._progress.tasks[0].elapsed or 0.0)
        total = None if share is None else 1.0
        self._progress.update(self._task, description=describe(job), completed=share or 0.0, total=total)


def done_share(job: dict[str, Any], elapsed_s: float) -> float | None:
    """Share of the work that is done, 0 to 1; None while it cannot be told."""
    progress = job["progress"]
    if job["state"] == "SUCCEEDED":
        return 1.0
    goal = job["goal"] or {}
    if "rel_error" not in goal and "seconds" not in goal and progress["tiles_total"]:
        return float(progress["tiles_done"] / progress["tiles_total"])
    if progress["eta_seconds"] is None or elapsed_s <= 0:
        return None
    return float(elapsed_s / (elapsed_s + progress["eta_seconds"]))
