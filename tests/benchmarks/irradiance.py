"""Irradiance caching against path tracing: seconds to a true relative error, in two rooms of diffuse surfaces and in
one with a glass egg and metal shades.

    irradiance.py [--seeds 3] [--goals 0.05 0.02 0.01] [--reference-spp 2048] [--out out] [SCENE ...]

The reference is a long path-traced run in two halves, kept in the --out folder (delete them when a scene changes). For
the room with the glass egg paths would need days: its halves are by progressive photons, --egg-spp samples each. True
relMSE is the mean of (I - A) (I - B) / (R^2 + 0.01) over both halves A and B and their mean R: their noise is
independent, so that it drops out. Two threads; seconds are those of rendering, with all records. Processor seconds,
over the threads, stand beside them: those hardly change when the machine has other work.

Path tracing meets the first goal alone; the other end of its line is a half of a path-traced reference, at the same
seconds a sample: to the smaller goals it may take hours. Seconds to a true error lie between such points on a line of
logarithms, and beyond them go on as noise does, with the square of the error; the latter are marked with ~.
"""

import argparse
import json
import os
import resource
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import OpenEXR

ROOT = Path(__file__).parents[2]
ENGINE = Path(sys.executable).with_name("fluxfarm-engine")
SCENES_DATA = Path(os.environ.get("FLUXFARM_SCENES_DATA", ROOT.parent / "shared" / "scenes-data"))
THREADS = 2


@dataclass(frozen=True)
class Room:
    scene: Path
    size: str
    reference: str = "path"  # its method


ROOMS = {
    "interior": Room(ROOT / "scenes" / "interior" / "scene.xml", "160x90"),
    "cornell-box": Room(SCENES_DATA / "cornell-box" / "scene.xml", "256x256"),
    "veach-bidir": Room(SCENES_DATA / "veach-bidir" / "scene.xml", "64x36", "photon-progressive"),
}


@dataclass(frozen=True)
class Run:
    pixels: np.ndarray  # (height, width, 3) float64
    report: dict[str, Any]
    processor_seconds: float  # over the threads


@dataclass(frozen=True)
class Point:
    """A median over seeds."""

    error: float
    noise: float
    bias: float
    samples: float  # of a pixel
    seconds: float
    processor_seconds: float


def read(image: Path) -> np.ndarray:
    with OpenEXR.File(str(image), separate_channels=True) as file:
        return np.stack([file.channels()[c].pixels for c in "RGB"], axis=-1).astype(np.float64)


def render(name: str, image: Path, method: str, seed: int, *goal: object) -> Run:
    room = ROOMS[name]
    report = image.with_suffix(".json")
    options = ("--size", room.size, "--threads", THREADS, "--seed", seed, "--report", report, *goal)
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run(
        [str(part) for part in (ENGINE, "render", room.scene, "-o", image, "--integrator", method, *options)],
        check=True,
    )
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return Run(read(image), json.loads(report.read_text()), (after.ru_utime - before.ru_utime) / THREADS)


def reference_halves(name: str, out: Path, spp: int) -> tuple[np.ndarray, np.ndarray]:
    halves = []
    for seed in (900, 901):
        image = out / f"reference-{name}-{ROOMS[name].size}-{spp}-{seed}.exr"
        if not image.exists():
            unfinished = image.with_stem("unfinished")
            render(name, unfinished, ROOMS[name].reference, seed, "--spp", spp)
            unfinished.rename(image)
        halves.append(read(image))
    return halves[0], halves[1]


def true_error(pixels: np.ndarray, halves: tuple[np.ndarray, np.ndarray]) -> float:
    """The square root of relMSE; negative where the halves' noise leaves less than nothing of relMSE."""
    a, b = halves
    rel_mse = float(np.mean((pixels - a) * (pixels - b) / (((a + b) / 2) ** 2 + 0.01)))
    return float(np.sign(rel_mse) * np.sqrt(abs(rel_mse)))


def measure(name: str, method: str, goal: float, seeds: int, halves: tuple[np.ndarray, np.ndarray], out: Path) -> Point:
    rows = []
    for seed in range(1, seeds + 1):
        run = render(name, out / "run.exr", method, seed, "--rel-error", goal)
        error, seconds = run.report["error"], run.report["seconds"]["render"]
        samples = run.report["samples"] / run.pixels[..., 0].size
        true = true_error(run.pixels, halves)
        rows.append((true, error["noise"], error["bias"], samples, seconds, run.processor_seconds))
        for warning in run.report["warnings"]:
            print(f"  {method} {goal} seed {seed}: {warning}")
    point = Point(*(float(value) for value in np.median(rows, axis=0)))
    if not point.error > 0:
        sys.exit(f"{name}: the noise of the reference hides the error of {method}; --reference-spp has to be higher")
    errors = f"{point.error:.4f} | {point.noise:.4f} | {point.bias:.4f}"
    seconds = f"{point.seconds:.1f} | {point.processor_seconds:.1f}"
    print(f"| {name} | {method} | {goal} | {errors} | {point.samples:.0f} | {seconds} |", flush=True)
    return point


def seconds_to(goal: float, runs: list[tuple[float, float]]) -> tuple[float, str]:
    """Of (true error, seconds), and ~ if the goal lies beyond them."""
    errors, seconds = np.log(np.array(sorted(runs))).T
    wanted = np.log(goal)
    beyond = max(errors[0] - wanted, 0.0) + min(errors[-1] - wanted, 0.0)
    return float(np.exp(np.interp(wanted, errors, seconds) + 2 * beyond)), "~" if beyond else ""


def compare(name: str, goals: list[float], seeds: int, spp: int, out: Path) -> None:
    a, b = halves = reference_halves(name, out, spp)
    half = float(np.sqrt(np.mean((a - b) ** 2 / (((a + b) / 2) ** 2 + 0.01)) / 2))
    print(f"\n{name}: relative error of a half of the reference ({spp} samples a pixel): {half:.4f}\n")
    print("| scene | method | goal | true error | claimed noise | bias | samples | seconds | processor seconds |")
    print("|---|---|---|---|---|---|---|---|---|", flush=True)
    path = measure(name, "path", goals[0], seeds, halves, out)
    cache = [measure(name, "irradiance-cache", goal, seeds, halves, out) for goal in goals]
    print("\n| scene | true error | path, s | irradiance-cache, s | ratio | ratio of processor seconds |")
    print("|---|---|---|---|---|---|")
    for goal in goals:
        cells, ratios = [], []
        for kind in ("seconds", "processor_seconds"):
            start = getattr(path, kind)
            runs = [(path.error, start)]
            if ROOMS[name].reference == "path":
                runs.append((half, start * spp / path.samples))
            of_path, path_beyond = seconds_to(goal, runs)
            of_cache, cache_beyond = seconds_to(goal, [(point.error, getattr(point, kind)) for point in cache])
            cells += [f"{path_beyond}{of_path:.1f}", f"{cache_beyond}{of_cache:.1f}"]
            ratios.append(f"{of_path / of_cache:.1f}")
        print(f"| {name} | {goal} | {cells[0]} | {cells[1]} | {ratios[0]} | {ratios[1]} |", flush=True)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scenes", nargs="*", metavar="SCENE", default=list(ROOMS), help=", ".join(ROOMS))
    parser.add_argument("--seeds", type=int, default=3)
    parser.add_argument("--goals", type=float, nargs="+", default=[0.05, 0.02, 0.01])
    parser.add_argument("--reference-spp", type=int, default=2048, help="samples a pixel in each half")
    parser.add_argument("--egg-spp", type=int, default=65536, help="the same for veach-bidir")
    parser.add_argument("--out", type=Path, default=ROOT / "out")
    options = parser.parse_args()
    folder = options.out / "irradiance"
    folder.mkdir(parents=True, exist_ok=True)
    for name in options.scenes:
        room = ROOMS[name]
        if room.scene.exists():
            spp = options.reference_spp if room.reference == "path" else options.egg_spp
            compare(name, options.goals, options.seeds, spp, folder)
        else:
            print(f"left out: {room.scene} does not exist (set FLUXFARM_SCENES_DATA)")


if __name__ == "__main__":
    main()
