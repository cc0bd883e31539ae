"""Does "auto" choose well? Its time to an error goal, pilot and all, against that of each single method; what it
foretold of that time; and the true error of every run.

    chooser.py [--goals 0.05 0.02] [--seeds 3] [--most-seconds 120] [--out out] [SCENE ...]

Goals below 3 % are for smaller pictures. Two threads; seconds are those of preparing and rendering, medians over the
seeds. A method that takes longer than --most-seconds, or that does not render the scene, is shown as such; of the slow
ones the limit counts, so that "worst over auto" is a lower bound. One that ends early, as it knows that it will not get
there, counts as slow. Progressive photons are left out where they are path tracing, bit by bit.

The reference are two independent runs to half the goal, kept in the --out folder (delete them when a scene
changes). True relMSE is the mean of (I - A) (I - B) / (R^2 + 0.01) over both, A and B, and their mean R: their noise
drops out, but not what both have missed where rare samples are bright. With halves no better than the goal plates have
0.054 to 0.079 of 0.05, where 4096 samples a pixel tell 0.046 to 0.050.
"""

import argparse
import json
import os
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import OpenEXR

ROOT = Path(__file__).parents[2]
ENGINE = Path(sys.executable).with_name("fluxfarm-engine")
OUTSIDE = Path(os.environ.get("FLUXFARM_SCENES_DATA", ROOT.parent / "shared" / "scenes-data"))
METHODS = ("path", "photon-progressive", "irradiance-cache")
THREADS = 2


@dataclass(frozen=True)
class Subject:
    scene: Path
    # Of the picture, for goals from 3 % on and for smaller ones: the best method takes a second or more, and references
    # can be had.
    coarse: str
    fine: str

    def size(self, goal: float) -> str:
        return self.coarse if goal >= 0.03 else self.fine


SCENES = {
    "cornell": Subject(ROOT / "scenes" / "cornell" / "scene.xml", "256x256", "192x192"),
    "cornell-glass": Subject(ROOT / "scenes" / "cornell-glass" / "scene.xml", "192x192", "96x96"),
    "furnace": Subject(ROOT / "scenes" / "furnace" / "scene.xml", "256x192", "256x192"),
    "interior": Subject(ROOT / "scenes" / "interior" / "scene.xml", "128x72", "64x36"),
    "plates": Subject(ROOT / "tests" / "benchmarks" / "plates.xml", "256x256", "128x128"),
    "cornell-box": Subject(OUTSIDE / "cornell-box" / "scene.xml", "256x256", "192x192"),
    "veach-mis": Subject(OUTSIDE / "veach-mis" / "scene.xml", "256x144", "128x72"),
    "veach-bidir": Subject(OUTSIDE / "veach-bidir" / "scene.xml", "64x36", "32x18"),
    "veach-ajar": Subject(OUTSIDE / "veach-ajar" / "scene.xml", "64x36", "32x18"),
    "water-caustic": Subject(OUTSIDE / "water-caustic" / "scene.xml", "96x54", "64x36"),
    "glass-of-milk": Subject(OUTSIDE / "glass-of-milk" / "scene.xml", "32x32", "16x16"),
    "gltf-cornell-glass": Subject(OUTSIDE / "gltf-cornell-glass" / "scene.glb", "128x128", "64x64"),
}


Halves = tuple[np.ndarray, np.ndarray]


@dataclass(frozen=True)
class Run:
    pixels: np.ndarray  # (height, width, 3) float64
    report: dict[str, Any]

    @property
    def seconds(self) -> float:
        return float(self.report["seconds"]["prepare"] + self.report["seconds"]["render"])


@dataclass(frozen=True)
class Outcome:
    """Of one method, over the seeds. `seconds` is a limit if it was not met."""

    seconds: float
    met: bool
    errors: list[float]
    reports: list[dict[str, Any]]


def render(name: str, size: str, image: Path, method: str, seed: int, most: float | None, goal: float) -> Run | str:
    """The run, or why there is none. `most`: seconds."""
    report = image.with_suffix(".json")
    options = ("--size", size, "--threads", THREADS, "--seed", seed, "--integrator", method, "--report", report)
    command = [ENGINE, "render", SCENES[name].scene, "-o", image, *options, "--rel-error", goal]
    try:
        done = subprocess.run(
            [str(word) for word in command], capture_output=True, text=True, timeout=most, check=False
        )
    except subprocess.TimeoutExpired:
        return "slow"
    if done.returncode != 0:
        return done.stderr.strip().splitlines()[-1].removeprefix("error: ")
    run = Run(read(image), json.loads(report.read_text()))
    return "slow" if any(warning.startswith("goal not reached") for warning in run.report["warnings"]) else run


def read(image: Path) -> np.ndarray:
    with OpenEXR.File(str(image), separate_channels=True) as file:
        return np.stack([file.channels()[c].pixels for c in "RGB"], axis=-1).astype(np.float64)


def reference(name: str, goal: float, folder: Path) -> Halves:
    halves = []
    for seed in (900, 901):
        size = SCENES[name].size(goal)
        image = folder / f"reference-{name}-{size}-{goal / 2:g}-{seed}.exr"
        if not image.exists():
            found = render(name, size, image, "photon-progressive", seed, None, goal / 2)
            if isinstance(found, str):
                sys.exit(f"{name}: no reference: {found}")
        halves.append(read(image))
    return halves[0], halves[1]


def true_error(pixels: np.ndarray, halves: Halves) -> float:
    """The square root of relMSE; negative where the halves' noise leaves less than nothing of relMSE."""
    a, b = halves
    rel_mse = float(np.mean((pixels - a) * (pixels - b) / (((a + b) / 2) ** 2 + 0.01)))
    return float(np.sign(rel_mse) * np.sqrt(abs(rel_mse)))


def measure(name: str, method: str, goal: float, seeds: int, most: float, truth: Halves, folder: Path) -> Outcome | str:
    seconds, errors, reports = [], [], []
    for seed in range(1, seeds + 1):
        run = render(name, SCENES[name].size(goal), folder / "run.exr", method, seed, most, goal)
        if run == "slow":
            return Outcome(most, False, [], [])
        if isinstance(run, str):
            return run
        seconds.append(run.seconds)
        errors.append(true_error(run.pixels, truth))
        reports.append(run.report)
    return Outcome(float(np.median(seconds)), True, errors, reports)


def is_path(auto: Outcome) -> bool:
    """Whether progressive photons are path tracing here, by the plan of "auto"."""
    choices = [report["plan"]["choice"]["methods"] for report in auto.reports]
    return any(m["reason"].startswith("no light") for methods in choices for m in methods)


def compare(name: str, goal: float, options: argparse.Namespace, truth: Halves, folder: Path) -> dict[str, Any]:
    outcomes: dict[str, Outcome] = {}
    for method in ("auto", *METHODS):
        if method == "photon-progressive" and "auto" in outcomes and is_path(outcomes["auto"]):
            continue
        outcome = measure(name, method, goal, options.seeds, options.most_seconds, truth, folder)
        if isinstance(outcome, str):
            print(f"  {name}: {method} left out: {outcome}")
        else:
            outcomes[method] = outcome
    auto = outcomes.get("auto") or sys.exit(f"{name}: auto did not render it")
    singles = {method: outcome for method, outcome in outcomes.items() if method != "auto"}
    best = min(singles, key=lambda method: singles[method].seconds)
    worst = max(singles, key=lambda method: singles[method].seconds)
    foretold = [
        report["plan"]["choice"]["expected_seconds"] / (report["seconds"]["prepare"] + report["seconds"]["render"])
        for report in auto.reports
    ]
    row = {
        "scene": name,
        "goal": goal,
        "chosen": sorted({report["integrator"] for report in auto.reports}),
        "seconds": {method: outcome.seconds if outcome.met else None for method, outcome in outcomes.items()},
        "auto_over_best": auto.seconds / singles[best].seconds,
        "worst_over_auto": singles[worst].seconds / auto.seconds,
        "foretold_over_taken": foretold,
        "true_errors": {method: outcome.errors for method, outcome in outcomes.items()},
    }
    cells = [f"{outcomes[m].seconds:.2f}" if m in outcomes and outcomes[m].met else "-" for m in ("auto", *METHODS)]
    largest = max((error for outcome in outcomes.values() for error in outcome.errors), default=float("nan"))
    words = (
        name,
        f"{goal:g}",
        ", ".join(row["chosen"]) or "-",
        *cells,
        f"{row['auto_over_best']:.2f}",
        f"{row['worst_over_auto']:.1f}",
        ", ".join(f"{ratio:.2f}" for ratio in foretold) or "-",
        f"{largest:.4f}",
    )
    print("| " + " | ".join(words) + " |", flush=True)
    return row


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scenes", nargs="*", metavar="SCENE", default=list(SCENES), help=", ".join(SCENES))
    parser.add_argument("--goals", type=float, nargs="+", default=[0.05, 0.02])
    parser.add_argument("--seeds", type=int, default=3)
    parser.add_argument("--most-seconds", type=float, default=120)
    parser.add_argument("--out", type=Path, default=ROOT / "out")
    options = parser.parse_args()
    folder = options.out / "chooser"
    folder.mkdir(parents=True, exist_ok=True)
    columns = ("scene", "goal", "chosen", "auto, s", *(f"{method}, s" for method in METHODS))
    columns += ("auto over best", "worst over auto", "foretold over taken", "largest true error")
    print("| " + " | ".join(columns) + " |\n|" + "---|" * len(columns), flush=True)
    rows = []
    for name in options.scenes:
        if not SCENES[name].scene.exists():
            print(f"  left out: {SCENES[name].scene} does not exist (set FLUXFARM_SCENES_DATA)")
            continue
        rows += [compare(name, goal, options, reference(name, goal, folder), folder) for goal in options.goals]
    (folder / "chooser.json").write_text(json.dumps(rows, indent=2) + "\n")


if __name__ == "__main__":
    main()
