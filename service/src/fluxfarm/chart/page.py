"""One page, without scripts: the charts, their figures, parts of the pictures, and the plans."""

from collections.abc import Sequence
from html import escape
from pathlib import Path

from fluxfarm.chart.crops import Crop
from fluxfarm.chart.engine import THREADS
from fluxfarm.chart.figure import slope_text
from fluxfarm.chart.measure import Measured
from fluxfarm.chart.record import front
from fluxfarm.chart.series import Series, medians, summaries

STYLE = """body{font-family:sans-serif;max-width:1300px;margin:2em auto;padding:0 1em}
table{border-collapse:collapse}td,th{border:1px solid #ccc;padding:.2em .6em;text-align:right}
th:first-child,td:first-child{text-align:left}.crops{display:flex;flex-wrap:wrap;gap:1em}
figure{margin:0}figure img{display:block;width:192px;image-rendering:pixelated}figcaption{font-size:.8em}
.chart{max-width:100%}pre{background:#f4f4f4;padding:1em;overflow:auto}"""
HEADS = ("method", "seconds", "spp", "relMSE", "claimed relMSE", "claimed / true", "slope", "FLIP", "on the front")


def write_page(out: Path, command: str, scenes: Sequence[tuple[Measured, list[Crop]]]) -> None:
    """index.html in the folder `out`, beside the charts; `command` is what made it."""
    parts = [
        '<!doctype html><html lang="en"><meta charset="utf-8"><title>Speed against accuracy</title>',
        f"<style>{STYLE}</style>",
        f"<h1>Speed against accuracy</h1><p>Made by <code>{escape(command)}</code>, {THREADS} threads.</p>",
    ]
    for measured, crops in scenes:
        parts += _scene(out, measured, crops)
    (out / "index.html").write_text("\n".join([*parts, "</html>"]) + "\n")


def _scene(out: Path, measured: Measured, crops: list[Crop]) -> list[str]:
    name, (width, height) = escape(measured.scene), measured.size
    origin, own = escape(measured.reference.origin), measured.reference.rel_mse
    claim = "unknown" if own is None else f"{own:.2g}"
    return [
        f'<h2 id="{name}">{name}</h2><p>{width} x {height} pixels. Reference: {origin}; its own relMSE: {claim}.</p>',
        f'<p><a href="{name}.svg"><img class="chart" src="{name}.svg" alt="Errors over time on {name}"></a></p>',
        *_table(measured),
        *(f"<p>Left out: {escape(who)}: {escape(why)}</p>" for who, why in measured.left_out.items()),
        "<h3>At equal time</h3><p>The part of the picture with the largest errors; below, FLIP, black is none.</p>",
        '<div class="crops">',
        *(_figure(out, crop) for crop in crops),
        f"</div><h3>Plan</h3><pre>{escape(measured.plan)}</pre>",
    ]


def _table(measured: Measured) -> list[str]:
    best = set(front(measured, "rel_mse"))
    rows = ["<table><tr>" + "".join(f"<th>{head}</th>" for head in HEADS) + "</tr>"]
    for series in measured.series:
        rows.append("<tr>" + "".join(f"<td>{escape(cell)}</td>" for cell in _cells(series, best)) + "</tr>")
    return [*rows, "</table><p>Medians of the seeds at the longest budget; slopes over all budgets.</p>"]


def _cells(series: Series, best: set[tuple[float, float]]) -> list[str]:
    last = summaries(series, "rel_mse")[-1]
    (_, samples) = medians(series, lambda run: run.spp)[-1]
    claims = dict(medians(series, lambda run: run.claimed_rel_mse))
    claimed = claims.get(last.seconds)
    on_front = sum((row.seconds, row.error) in best for row in summaries(series, "rel_mse"))
    return [
        series.name,
        f"{last.seconds:.2f}",
        f"{samples:.4g}",
        f"{last.error:.3g}",
        "-" if claimed is None else f"{claimed:.3g}",
        "-" if claimed is None or last.error == 0 else f"{claimed / last.error:.2f}",
        slope_text(series.slope("rel_mse")),
        f"{summaries(series, 'flip')[-1].error:.3g}",
        f"{on_front} of {len(series.budgets())}",
    ]


def _figure(out: Path, crop: Crop) -> str:
    images = [path.relative_to(out).as_posix() for path in (crop.picture, crop.errors) if path is not None]
    shown = "".join(f'<img src="{escape(image)}" alt="{escape(crop.name)}">' for image in images)
    return f"<figure>{shown}<figcaption>{escape(crop.name)}</figcaption></figure>"
