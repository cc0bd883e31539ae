"""Caustics in a given time: our methods, and LuxCore's path tracer with and without its cache of caustic photons.

    caustics.py [--seconds 10] [--out out]

relMSE in the pixels of cornell-glass in which caustics are half of the light or more. The reference is progressive
photon mapping with disks a quarter as wide; that it agrees with path tracing, tests say. Two threads; the time is that
of rendering, with all photons. LuxCore is measured where LUXCORE_PYTHON names a Python that has pyluxcore.
"""

import argparse
import json
import os
import subprocess
from pathlib import Path

import numpy as np
import OpenEXR
import peers

from fluxfarm.peers.running import run_peer

ENGINE = peers.ROOT / ".venv" / "bin" / "fluxfarm-engine"
REFERENCE_SPP = 2048
CAUSTIC_SHARE = 0.5
METHODS = ("path", "photon", "irradiance-cache", "photon-progressive")


def render(scene: Path, out: Path, method: str, *goal: object) -> tuple[np.ndarray, np.ndarray, float]:
    """Beauty and caustics (side, side, 3), and the seconds of rendering."""
    image, report = out / "caustics.exr", out / "caustics.json"
    options = (
        "--size",
        f"{peers.SIDE}x{peers.SIDE}",
        "--threads",
        2,
        "--report",
        report,
        "-D",
        f"max_depth={peers.DEPTH}",
    )
    command = (ENGINE, "render", scene, "-o", image, "--integrator", method, *options, *goal)
    subprocess.run([str(part) for part in command], check=True)
    with OpenEXR.File(str(image), separate_channels=True) as file:
        channels = file.channels()
        beauty, caustic = (
            np.stack([channels[prefix + c].pixels for c in "RGB"], -1).astype(float) for prefix in ("", "caustic.")
        )
    return beauty, caustic, float(json.loads(report.read_text())["seconds"]["render"])


def of_luxcore(python: str, flat: Path, seconds: float) -> list[tuple[str, np.ndarray, float]]:
    size, out = (peers.SIDE, peers.SIDE), flat.with_name("luxcore.npz")
    variants = run_peer("luxcore", python, flat, size, peers.DEPTH, [seconds], out, "caustics")
    return [(runs.name, runs.images[0], float(runs.seconds[0])) for runs in variants]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seconds", type=float, default=10)
    parser.add_argument("--out", type=Path, default=peers.ROOT / "out")
    options = parser.parse_args()
    folder = options.out / "caustics"
    scene = peers.write_scenes(folder)["cornell-glass"]
    sharp = scene.with_name("sharp.xml")
    photon = '<integrator type="photon-progressive"><float name="radius" value="0.5"/>'
    sharp.write_text(scene.read_text().replace('<integrator type="path">', photon))
    reference, caustic, _ = render(sharp, folder, "", "--spp", REFERENCE_SPP, "--seed", 999)
    where = caustic.sum(-1) > CAUSTIC_SHARE * reference.sum(-1)
    runs = []
    for method in METHODS:
        image, _, seconds = render(scene, folder, method, "--seconds", options.seconds)
        runs.append((method, image, seconds))
    if python := os.environ.get("LUXCORE_PYTHON"):
        runs += of_luxcore(python, peers.flat_file(scene), options.seconds)
    else:
        print("left out: LuxCore, as LUXCORE_PYTHON names no Python that has it")
    print(f"caustics are half of the light in {np.mean(where):.1%} of the pixels")
    print(
        "| method | seconds | relMSE there | over photon-progressive | relMSE of the picture | mean to the reference |"
    )
    print("|---|---|---|---|---|---|")
    ours = next(peers.rel_mse(image[where], reference[where]) for name, image, _ in runs if name == METHODS[-1])
    for name, image, seconds in runs:
        there, whole = peers.rel_mse(image[where], reference[where]), peers.rel_mse(image, reference)
        mean = image.mean() / reference.mean()
        print(f"| {name} | {seconds:.1f} | {there:.3g} | {there / ours:.1f} | {whole:.3g} | {mean:.3f} |")


if __name__ == "__main__":
    main()
