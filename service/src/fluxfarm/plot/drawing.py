"""From panels of curves to one SVG: panels side by side, the legend and notes below."""

from collections.abc import Sequence
from xml.sax.saxutils import escape

from fluxfarm.plot.curves import Curve, Panel
from fluxfarm.plot.scale import LogScale, scale_of

WIDTH, HEIGHT, MARGIN = 640, 400, 56
LINE = 15


def draw(panels: Sequence[Panel], notes: Sequence[str] = ()) -> str:
    """An SVG of all panels. Curves of one name have one line in the legend; each of `notes` is a line below it."""
    legend = {curve.name: curve for panel in panels for curve in panel.curves if curve.name}
    width, height = WIDTH * len(panels), HEIGHT + LINE * (len(legend) + len(notes))
    box = f'viewBox="0 0 {width} {height}" width="{width}" height="{height}"'
    parts = [f'<svg xmlns="http://www.w3.org/2000/svg" {box} font-family="sans-serif" font-size="11">']
    parts.append(f'<rect width="{width}" height="{height}" fill="white"/>')
    for column, panel in enumerate(panels):
        parts += [f'<g transform="translate({column * WIDTH} 0)">', *_panel(panel), "</g>"]
    for row, curve in enumerate(legend.values()):
        y = HEIGHT + LINE * row
        parts.append(f'<path d="M{MARGIN} {y - 4}h40" {_stroke(curve)}/>')
        parts.append(f'<text x="{MARGIN + 48}" y="{y}">{escape(curve.name)}</text>')
    for row, note in enumerate(notes):
        y = HEIGHT + LINE * (len(legend) + row)
        parts.append(f'<text x="{MARGIN}" y="{y}" fill="#555">{escape(note)}</text>')
    return "\n".join([*parts, "</svg>"])


def _panel(panel: Panel) -> list[str]:
    names = [
        f'<text x="{WIDTH / 2:g}" y="{HEIGHT - 22}" text-anchor="middle">{escape(panel.across)}</text>',
        f'<text x="{MARGIN}" y="{MARGIN - 16}">{escape(panel.up)}</text>',
    ]
    values = [value for curve in panel.curves for value in curve.values()]
    if not values:
        return names
    x = scale_of([value for value, _ in values], MARGIN, WIDTH - MARGIN)
    y = scale_of([value for _, value in values], HEIGHT - MARGIN, MARGIN)
    parts = _grid(x, y)
    for curve in panel.curves:
        parts += _curve(curve, x, y)
    return [*parts, *names]


def _grid(x: LogScale, y: LogScale) -> list[str]:
    parts = []
    for tick in x.ticks():
        at = x.place(tick)
        parts.append(f'<path d="M{at:.1f} {y.end:g}V{y.start:g}" stroke="#ddd"/>')
        parts.append(f'<text x="{at:.1f}" y="{y.start + 16:g}" text-anchor="middle">{tick:g}</text>')
    for tick in y.ticks():
        at = y.place(tick)
        parts.append(f'<path d="M{x.start:g} {at:.1f}H{x.end:g}" stroke="#ddd"/>')
        parts.append(f'<text x="{x.start - 6:g}" y="{at + 4:.1f}" text-anchor="end">{tick:g}</text>')
    return parts


def _curve(curve: Curve, x: LogScale, y: LogScale) -> list[str]:
    parts = []
    if curve.band:
        above = [(x.place(at), y.place(high)) for at, _, high in curve.band]
        below = [(x.place(at), y.place(low)) for at, low, _ in reversed(curve.band)]
        parts.append(f'<polygon points="{_pairs(above + below)}" fill="{curve.colour}" fill-opacity="0.18"/>')
    line = [(x.place(at), y.place(value)) for at, value in curve.points]
    parts.append(f'<polyline points="{_pairs(line)}" fill="none" {_stroke(curve)}/>')
    if curve.dots:
        parts += [f'<circle cx="{cx:.1f}" cy="{cy:.1f}" r="3" fill="{curve.colour}"/>' for cx, cy in line]
    for at, value in curve.diamonds:
        shape = f"M{x.place(at):.1f} {y.place(value) - 5:.1f}l5 5l-5 5l-5 -5z"
        parts.append(f'<path d="{shape}" fill="white" stroke="{curve.colour}"/>')
    return parts


def _stroke(curve: Curve) -> str:
    return f'stroke="{curve.colour}" stroke-width="{curve.width:g}" stroke-dasharray="{curve.dashes}"'


def _pairs(places: list[tuple[float, float]]) -> str:
    return " ".join(f"{px:.1f},{py:.1f}" for px, py in places)
