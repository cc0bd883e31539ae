"""What was measured of one method: points over budgets and seeds, their medians and ranges, slopes, and the front."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from statistics import median

MEASURES = ("rel_mse", "flip")


@dataclass(frozen=True, slots=True)
class Point:
    """One run. `budget` counts the budgets from 0; `claimed_rel_mse` is what the run itself says (None: nothing)."""

    budget: int
    seed: int
    seconds: float
    spp: float
    rel_mse: float
    flip: float
    claimed_rel_mse: float | None = None
    rays: int | None = None


@dataclass(frozen=True, slots=True)
class Summary:
    """Medians over the seeds of one budget, and the range of the measured error."""

    seconds: float
    error: float
    lowest: float
    highest: float


@dataclass(frozen=True, slots=True)
class Series:
    """One method of ours, or a peer."""

    name: str
    points: list[Point]

    def at(self, budget: int) -> list[Point]:
        """The runs of one budget."""
        return [point for point in self.points if point.budget == budget]

    def slope(self, measure: str) -> float | None:
        """Of the error over time, all runs together; None where it is not known. `measure` is one of MEASURES.

        Runs of one seed that took equally many samples are the same picture: the quickest counts."""
        quickest: dict[tuple[int, float], Point] = {}
        for point in sorted(self.points, key=lambda point: point.seconds):
            quickest.setdefault((point.seed, point.spp), point)
        if len({spp for _, spp in quickest}) < 2:
            return None
        return slope([(point.seconds, float(getattr(point, measure))) for point in quickest.values()])

    def budgets(self) -> list[int]:
        """Those that were measured."""
        return sorted({point.budget for point in self.points})


def summaries(series: Series, measure: str) -> list[Summary]:
    """One for each budget, in their order; `measure` is one of MEASURES."""
    found = []
    for budget in series.budgets():
        runs = series.at(budget)
        errors = [float(getattr(run, measure)) for run in runs]
        found.append(Summary(median(run.seconds for run in runs), median(errors), min(errors), max(errors)))
    return found


def medians(series: Series, value: Callable[[Point], float | None]) -> list[tuple[float, float]]:
    """(seconds, value) of each budget of which all runs have the value."""
    found = []
    for budget in series.budgets():
        runs = series.at(budget)
        values = [told for told in map(value, runs) if told is not None]
        if len(values) == len(runs):
            found.append((median(run.seconds for run in runs), median(values)))
    return found


def slope(pairs: Sequence[tuple[float, float]]) -> float | None:
    """Of the line of least squares through the logarithms of (seconds, error): -1 for relMSE of independent samples.

    None for fewer than two different times, or errors that have no logarithm."""
    if len({seconds for seconds, _ in pairs}) < 2 or not all(error > 0 for _, error in pairs):
        return None
    x = [math.log(seconds) for seconds, _ in pairs]
    y = [math.log(error) for _, error in pairs]
    x_mean, y_mean = sum(x) / len(x), sum(y) / len(y)
    above = sum((a - x_mean) * (b - y_mean) for a, b in zip(x, y, strict=True))
    return above / sum((a - x_mean) ** 2 for a in x)


def pareto_front(pairs: Sequence[tuple[float, float]]) -> list[tuple[float, float]]:
    """Those (seconds, error) that no other beats in both, by time."""
    front: list[tuple[float, float]] = []
    for seconds, error in sorted(set(pairs)):
        if not front or error < front[-1][1]:
            front.append((seconds, error))
    return front
