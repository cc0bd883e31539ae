"""The chart of a scene: relMSE and FLIP over seconds, side by side."""

from fluxfarm.chart.measure import Measured
from fluxfarm.chart.record import front
from fluxfarm.chart.series import Series, medians, summaries
from fluxfarm.plot import Curve, Panel, draw

COLOURS = {
    "path": "#06c",
    "photon": "#c40",
    "photon-progressive": "#083",
    "irradiance-cache": "#808",
    "Mitsuba": "#b80",
    "Cycles": "#07888f",
    "LuxCore": "#c36",
}
PEER_DASHES = "7 3"
SECONDS = "seconds of rendering"


def figure(measured: Measured) -> str:
    """An SVG. A line is the median over the seeds, its band their range, a diamond what the method itself claims."""
    errors, seen = Panel([], SECONDS, f"{measured.scene}: relMSE"), Panel([], SECONDS, "FLIP, mean")
    for panel, measure in ((errors, "rel_mse"), (seen, "flip")):
        best = [pair for pair in front(measured, measure) if pair[1] > 0]
        panel.curves.append(Curve(best, "Pareto front", "#ccc", width=9, dots=False))
        panel.curves.extend(_curve(series, measure) for series in measured.series)
    if floor := [pair for pair in measured.floor() if pair[1] > 0]:
        errors.curves.append(Curve(floor, "path, if only bare Embree took time", "#000", "1 3", dots=False))
    seconds = [x for curve in errors.curves for x, _ in curve.values()]
    own = measured.reference.rel_mse
    if own and seconds:
        line = [(min(seconds), own), (max(seconds), own)]
        name = f"claimed by the reference itself ({measured.reference.origin})"
        errors.curves.append(Curve(line, name, "#555", "2 5", 1, dots=False))
    return draw([errors, seen], notes(measured))


def notes(measured: Measured) -> list[str]:
    """What the lines mean, and who is missing and why."""
    how = "line: median of the seeds; band: their range; diamond: what the method claims of itself (noise and bias)"
    return [how, *(f"left out: {name}: {why}" for name, why in measured.left_out.items())]


def _curve(series: Series, measure: str) -> Curve:
    kind = series.name.split(",", maxsplit=1)[0]
    rows = [row for row in summaries(series, measure) if row.lowest > 0]
    claimed = medians(series, lambda run: run.claimed_rel_mse) if measure == "rel_mse" else []
    return Curve(
        points=[(row.seconds, row.error) for row in rows],
        name=f"{series.name}: slope {slope_text(series.slope('rel_mse'))} of relMSE",
        colour=COLOURS[kind],
        dashes="none" if kind in {"path", "photon", "photon-progressive", "irradiance-cache"} else PEER_DASHES,
        band=[(row.seconds, row.lowest, row.highest) for row in rows],
        diamonds=[pair for pair in claimed if pair[1] > 0],
    )


def slope_text(value: float | None) -> str:
    """With its sign, or that there is none."""
    return "unknown" if value is None else f"{value:+.2f}"
