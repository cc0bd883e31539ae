"""The body of `fluxfarm chart`."""

import json
from collections.abc import Sequence
from pathlib import Path

from fluxfarm.chart.crops import Crop, write_crops
from fluxfarm.chart.figure import figure
from fluxfarm.chart.measure import Measured, measure
from fluxfarm.chart.options import ChartOptions
from fluxfarm.chart.page import write_page
from fluxfarm.chart.raster import png_of
from fluxfarm.chart.record import as_json
from fluxfarm.chart.scenes import ChartScene


def run(scenes: Sequence[ChartScene], program: Path, options: ChartOptions, command: str) -> None:
    """Measure all scenes with the engine `program`; after each, the files hold all that was measured so far."""
    options.out.mkdir(parents=True, exist_ok=True)
    done: list[tuple[Measured, list[Crop]]] = []
    for scene in scenes:
        measured = measure(scene, program, options, print)
        svg = figure(measured)
        (options.out / f"{scene.name}.svg").write_text(svg)
        (options.out / f"{scene.name}.png").write_bytes(png_of(svg))
        done.append((measured, write_crops(measured, options.out / "crops")))
        record = {"command": command, "scenes": [as_json(each) for each, _ in done]}
        (options.out / "chart.json").write_text(json.dumps(record, indent=1) + "\n")
        write_page(options.out, command, done)
    print(options.out / "index.html")
