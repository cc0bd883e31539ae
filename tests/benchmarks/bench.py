"""Speed with its error: path tracing against bare Embree on its own rays, with a thousand emitters against ten, and
against its peers at equal error.

    .venv/bin/python tests/benchmarks/bench.py --out out/bench.json

Writes bench.json and, by peers.py, peers.md (the table) and peers.svg (error over time).
"""

import argparse
import json
import os
import subprocess
import sys
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np
import OpenEXR

sys.path.insert(0, str(Path(__file__).parent))
import many_lights
import million
import peers

ROOT = Path(__file__).parents[2]
ENGINE = Path(sys.executable).with_name("fluxfarm-engine")
SCENES_DATA = Path(os.environ.get("FLUXFARM_SCENES_DATA", ROOT.parent / "shared" / "scenes-data"))
THREADS = "2"


def scenes(out: Path) -> dict[str, Path]:
    """The scenes there are, by name."""
    found = {"million": million.write(out.parent / "million")}
    for name in ("cornell-box", "veach-bidir"):
        scene = SCENES_DATA / name / "scene.xml"
        if scene.exists():
            found[name] = scene
        else:
            print(f"left out: {scene} does not exist (set FLUXFARM_SCENES_DATA)")
    return found


def ray_rates(scene: Path) -> dict[str, Any]:
    command = [ENGINE, "bench", "path", scene, "--threads", THREADS, "--size", f"{peers.SIDE}x{peers.SIDE}", "--json"]
    return dict(json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout))


def render(scene: Path, out: Path, goal: tuple[str, float], seed: int, *more: str) -> tuple[np.ndarray, float]:
    """(height, width, 3) float64 and the seconds of rendering alone. more: further options of the engine's command."""
    image, report = out.parent / "bench.exr", out.parent / "bench-report.json"
    options = [
        "--size",
        f"{peers.SIDE}x{peers.SIDE}",
        *map(str, goal),
        "--seed",
        str(seed),
        "--threads",
        THREADS,
        *more,
    ]
    subprocess.run([ENGINE, "render", scene, "-o", image, "--report", report, *options], check=True)
    with OpenEXR.File(str(image), separate_channels=True) as file:
        pixels = np.stack([file.channels()[c].pixels for c in "RGB"], axis=-1).astype(np.float64)
    return pixels, float(json.loads(report.read_text())["seconds"]["render"])


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=Path, default=ROOT / "out" / "bench.json")
    options = parser.parse_args()
    options.out.parent.mkdir(parents=True, exist_ok=True)
    out = options.out.resolve()
    results: dict[str, Any] = {"rays": {}}
    for name, scene in scenes(out).items():
        rates = results["rays"][name] = ray_rates(scene)
        print(
            f"{name}: path {rates['path_rays_per_second'] / 1e6:.2f} M rays/s, bare Embree "
            f"{rates['embree_rays_per_second'] / 1e6:.2f} M rays/s, ratio {rates['ratio']:.3f}, "
            f"{rates['path_samples_per_second'] / 1e6:.2f} M samples/s"
        )
    results["many-lights"] = many_lights.compare(
        out.parent, lambda scene, spp, seed: render(scene, out, ("--spp", spp), seed)
    )
    depth = f"max_depth={peers.DEPTH}"
    compared = peers.compare(out.parent, lambda scene, goal, seed: render(scene, out, goal, seed, "-D", depth))
    results["peers"] = {name: [asdict(row) for row in rows] for name, rows in compared.items()}
    out.write_text(json.dumps(results, indent=2) + "\n")
    print(out)


if __name__ == "__main__":
    main()
