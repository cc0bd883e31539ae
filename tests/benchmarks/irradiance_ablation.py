"""What the radius rule and the gradients of an irradiance cache are worth: errors of caches with equal records, a table
and a plot a scene.

    irradiance_ablation.py [--records 100 200 500 1000 2000] [--strata 64] [--out out] [SCENE ...]

Measured by build/release/irradiance_ablation (tests/benchmarks/irradiance_ablation), which is built with the tests.
"""

import argparse
import json
import math
import os
import subprocess
from pathlib import Path
from typing import Any

from fluxfarm.plot import Curve, Panel, draw

ROOT = Path(__file__).parents[2]
PROGRAM = ROOT / "build" / "release" / "irradiance_ablation"
SCENES_DATA = Path(os.environ.get("FLUXFARM_SCENES_DATA", ROOT.parent / "shared" / "scenes-data"))
SCENES = {
    "cornell": (ROOT / "scenes" / "cornell" / "scene.xml", "128x128"),
    "interior": (ROOT / "scenes" / "interior" / "scene.xml", "160x90"),
    "cornell-box": (SCENES_DATA / "cornell-box" / "scene.xml", "128x128"),
}
# Of the plot; the others are in the table alone. Without gradients dashed.
COLOURS = {
    "pure split-sphere": "#b00",
    "bounded split-sphere": "#e80",
    "geometric Hessian, sum": "#090",
    "occlusion Hessian": "#06c",
    "occlusion Hessian, bounded": "#609",
    "as shipped": "#000",
}


def measure(name: str, options: argparse.Namespace) -> dict[str, Any]:
    scene, size = SCENES[name]
    arguments = [PROGRAM, scene, "--size", size, "--strata", options.strata, "--threads", options.threads, "--records"]
    arguments += options.records
    done = subprocess.run([str(a) for a in arguments], check=True, stdout=subprocess.PIPE, text=True)
    result: dict[str, Any] = json.loads(done.stdout)
    return result


def interpolation(row: dict[str, Any], rms: str) -> float:
    """The error without the noise of the records, over the mean irradiance."""
    return math.sqrt(max(row[rms] ** 2 - row["noise"] ** 2, 0.0))


def table(result: dict[str, Any], rms: str) -> str:
    sizes = sorted({row["wanted"] for row in result["rows"]})
    cells: dict[str, dict[int, float]] = {}
    for row in result["rows"]:
        cells.setdefault(row["method"], {})[row["wanted"]] = interpolation(row, rms)
    lines = ["| method | " + " | ".join(f"{size}" for size in sizes) + " |", "|---" * (len(sizes) + 1) + "|"]
    for method, errors in cells.items():
        lines.append(f"| {method} | " + " | ".join(f"{errors[s]:.4f}" if s in errors else "" for s in sizes) + " |")
    split, hessian = cells["bounded split-sphere"], cells["occlusion Hessian"]
    factors = [f"{split[s] / hessian[s]:.2f}" if s in split and s in hessian else "" for s in sizes]
    lines.append("| bounded split-sphere over occlusion Hessian | " + " | ".join(factors) + " |")
    return "\n".join(lines)


def plot(result: dict[str, Any]) -> str:
    curves = []
    for method in dict.fromkeys(row["method"] for row in result["rows"]):
        colour = COLOURS.get(method.removesuffix(", no gradients"))
        rows = sorted((row for row in result["rows"] if row["method"] == method), key=lambda row: row["records"])
        points = [(row["records"], interpolation(row, "rms")) for row in rows]
        if colour and points:
            curves.append(Curve(points, method, colour, "5 3" if method.endswith("no gradients") else "none"))
    return draw([Panel(curves, "records", "RMSE by interpolation, over the mean irradiance")])


def report(name: str, result: dict[str, Any]) -> str:
    noise = f"{result['noise_of_a_record']:.4f}"
    return f"""## {name}

{result["places"]} places, {result["paths"]} paths a record, whose noise is {noise} of the mean irradiance. RMSE by
interpolation over that mean, all places:

{table(result, "rms")}

The same without the hundredth of the places where the error is largest:

{table(result, "rms_of_99")}
"""


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scenes", nargs="*", metavar="SCENE", default=list(SCENES), help=", ".join(SCENES))
    parser.add_argument("--records", type=int, nargs="+", default=[100, 200, 500, 1000, 2000])
    parser.add_argument("--strata", type=int, default=64, help="a record's paths along a side of its hemisphere")
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--out", type=Path, default=ROOT / "out")
    options = parser.parse_args()
    folder = options.out / "irradiance-ablation"
    folder.mkdir(parents=True, exist_ok=True)
    for name in options.scenes:
        if not SCENES[name][0].exists():
            print(f"left out: {SCENES[name][0]} does not exist (set FLUXFARM_SCENES_DATA)")
            continue
        result = measure(name, options)
        (folder / f"{name}.json").write_text(json.dumps(result, indent=2))
        (folder / f"{name}.svg").write_text(plot(result))
        (folder / f"{name}.md").write_text(report(name, result))
        print(report(name, result), flush=True)


if __name__ == "__main__":
    main()
