"""Charts the estimated error over time of the authored scenes, an SVG each, from the engine's own reports.

.venv/bin/python tests/benchmarks/chart.py --out out
"""

import argparse
import json
import subprocess
import sys
from pathlib import Path

from fluxfarm.api.chart import Curve, draw

ROOT = Path(__file__).parents[2]
ENGINE = Path(sys.executable).with_name("fluxfarm-engine")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=Path, default=ROOT / "out")
    parser.add_argument("--spp", type=int, default=128)
    options = parser.parse_args()
    options.out.mkdir(parents=True, exist_ok=True)
    for scene in sorted((ROOT / "scenes").glob("*/scene.xml")):
        name, report = scene.parent.name, options.out / "report.json"
        arguments = [
            "-o",
            options.out / f"{name}.exr",
            "--size",
            "256x256",
            "--spp",
            str(options.spp),
            "--report",
            report,
        ]
        subprocess.run([ENGINE, "render", scene, *arguments], check=True)
        timeline = json.loads(report.read_text())["timeline"]
        chart = options.out / f"chart-{name}.svg"
        curve = Curve([(point["seconds"], point["error"]) for point in timeline if point["error"]])
        chart.write_text(draw([curve], "time of rendering, seconds", "estimated relative error (noise)"))
        print(chart)


if __name__ == "__main__":
    main()
