"""The measurements as JSON: every point, and what follows from them."""

from dataclasses import asdict
from typing import Any

from fluxfarm.chart.engine import THREADS
from fluxfarm.chart.measure import Measured
from fluxfarm.chart.series import MEASURES, pareto_front, summaries


def as_json(measured: Measured) -> dict[str, Any]:
    """One scene. Errors `rel_mse` and `flip` are against the reference, `claimed_rel_mse` is the run's own."""
    return {
        "scene": measured.scene,
        "size": measured.size,
        "threads": THREADS,
        "reference": {"origin": measured.reference.origin, "rel_mse": measured.reference.rel_mse},
        "embree_rays_per_second": measured.embree_rays_per_second,
        "floor": measured.floor(),
        "methods": [
            {
                "name": series.name,
                "slope": {measure: series.slope(measure) for measure in MEASURES},
                "medians": {measure: [asdict(row) for row in summaries(series, measure)] for measure in MEASURES},
                "points": [asdict(point) for point in series.points],
            }
            for series in measured.series
        ],
        "pareto": {measure: front(measured, measure) for measure in MEASURES},
        "left_out": measured.left_out,
    }


def front(measured: Measured, measure: str) -> list[tuple[float, float]]:
    """The Pareto front of all methods' medians."""
    return pareto_front([(row.seconds, row.error) for series in measured.series for row in summaries(series, measure)])
