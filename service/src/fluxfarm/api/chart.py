"""Curves of falling errors over time as an SVG, both axes logarithmic."""

import math
from dataclasses import dataclass

WIDTH, HEIGHT, MARGIN = 640, 400, 56
LEGEND_LINE = 15


@dataclass(frozen=True)
class Curve:
    """(x, y) pairs, all above 0. A name appears in the legend; `dashes` is SVG's stroke-dasharray."""

    points: list[tuple[float, float]]
    name: str = ""
    colour: str = "#06c"
    dashes: str = "none"


def draw(curves: list[Curve], across: str, up: str) -> str:
    """An SVG of the curves, with a grid line at each power of ten and the names of both axes."""
    legend = [curve for curve in curves if curve.name]
    height = HEIGHT + LEGEND_LINE * len(legend)
    x_low, x_high = _decades([x for curve in curves for x, _ in curve.points])
    y_low, y_high = _decades([y for curve in curves for _, y in curve.points])

    def place(x: float, y: float) -> tuple[float, float]:
        right = (math.log10(x) - x_low) / (x_high - x_low)
        above = (math.log10(y) - y_low) / (y_high - y_low)
        return MARGIN + right * (WIDTH - 2 * MARGIN), HEIGHT - MARGIN - above * (HEIGHT - 2 * MARGIN)

    box = f'viewBox="0 0 {WIDTH} {height}"'
    parts = [f'<svg xmlns="http://www.w3.org/2000/svg" {box} font-family="sans-serif" font-size="11">']
    parts.append(f'<rect width="{WIDTH}" height="{height}" fill="white"/>')
    for power in range(x_low, x_high + 1):
        x, _ = place(10.0**power, 10.0**y_low)
        parts.append(f'<path d="M{x:.1f} {MARGIN}V{HEIGHT - MARGIN}" stroke="#ddd"/>')
        parts.append(f'<text x="{x:.1f}" y="{HEIGHT - MARGIN + 16}" text-anchor="middle">{10.0**power:g}</text>')
    for power in range(y_low, y_high + 1):
        _, y = place(10.0**x_low, 10.0**power)
        parts.append(f'<path d="M{MARGIN} {y:.1f}H{WIDTH - MARGIN}" stroke="#ddd"/>')
        parts.append(f'<text x="{MARGIN - 6}" y="{y + 4:.1f}" text-anchor="end">{10.0**power:g}</text>')
    for curve in curves:
        stroke = f'stroke="{curve.colour}" stroke-width="2" stroke-dasharray="{curve.dashes}"'
        line = " ".join(f"{x:.1f},{y:.1f}" for x, y in (place(*point) for point in curve.points))
        parts.append(f'<polyline points="{line}" fill="none" {stroke}/>')
        for point in curve.points:
            x, y = place(*point)
            parts.append(f'<circle cx="{x:.1f}" cy="{y:.1f}" r="3" fill="{curve.colour}"/>')
    for row, curve in enumerate(legend):
        y = HEIGHT + LEGEND_LINE * row
        stroke = f'stroke="{curve.colour}" stroke-width="2" stroke-dasharray="{curve.dashes}"'
        parts.append(f'<path d="M{MARGIN} {y - 4}h40" {stroke}/><text x="{MARGIN + 48}" y="{y}">{curve.name}</text>')
    parts.append(f'<text x="{WIDTH / 2}" y="{HEIGHT - 12}" text-anchor="middle">{across}</text>')
    parts.append(f'<text x="{MARGIN}" y="{MARGIN - 16}">{up}</text></svg>')
    return "\n".join(parts)


def _decades(values: list[float]) -> tuple[int, int]:
    """Whole powers of ten around the values, at least one apart."""
    low = math.floor(math.log10(min(values)))
    return low, max(low + 1, math.ceil(math.log10(max(values))))
