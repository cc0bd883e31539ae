"""Time to equal error against Mitsuba 3, Cycles and LuxCore: four scenes of ours, two threads, equal depth.

Each renderer draws each scene with a few numbers of samples, the same in all pixels; ours also with goals of error, as
it is meant to be asked: the errors that those samples left. Its relMSE against a long run of ours and its seconds of
rendering alone (no loading, no compiling) lie about a line of error ~ 1 / time; the product of the two, in the
geometric mean over the points, gives the time to any error and the error in any time. A renderer whose mean picture is
another one is left out of the comparison and says so. Each is measured where its variable names a Python that has it.
Cycles' adaptive sampling is off: it ends pixels by their own samples, which biases the picture.
"""

import os
import re
import shutil
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import million
import numpy as np

from fluxfarm.peers import PYTHONS, flat_scene
from fluxfarm.peers.running import PeerFailed, reads_scene, run_peer
from fluxfarm.plot import Curve, Panel, draw

ROOT = Path(__file__).parents[2]
OURS = "Fluxfarm"  # and how it was asked
SIDE = 256
DEPTH = 16
COUNTS = (16, 32, 64)  # samples a pixel
REFERENCE_SPP = 2048
MEAN_TOLERANCE = 0.01  # of a channel's mean, besides three standard errors
COLOURS = {"cornell": "#06c", "cornell-glass": "#c40", "plates": "#083", "million": "#808"}
DASHES = {OURS: "none", "Mitsuba": "6 3", "Cycles": "2 3", "LuxCore": "9 3 2 3"}

# Scene, goal (an option of the engine's command and its value), seed to pixels (SIDE, SIDE, 3) and seconds.
Render = Callable[[Path, tuple[str, float], int], tuple[np.ndarray, float]]


@dataclass(frozen=True)
class Measured:
    """What one renderer did with one scene; `seconds` and `errors` (relMSE) for each of COUNTS or of our goals."""

    name: str
    seconds: list[float]
    errors: list[float]
    mean_ratio: list[float]  # of each channel, to the reference
    same_picture: bool

    @property
    def cost(self) -> float:
        """Seconds times relMSE, the same all along a line of error ~ 1 / time."""
        return float(np.exp(np.mean(np.log(np.multiply(self.seconds, self.errors)))))


def rel_mse(image: np.ndarray, reference: np.ndarray) -> float:
    """Mean over pixels and channels of (I - R)^2 / (R^2 + 1e-2)."""
    return float(np.mean((image - reference) ** 2 / (reference**2 + 1e-2)))


def write_scenes(folder: Path) -> dict[str, Path]:
    """The four scenes with a box filter and without a sampler, so that all renderers can be given the same."""
    sources = {name: ROOT / "scenes" / name / "scene.xml" for name in ("cornell", "cornell-glass")}
    sources["plates"] = Path(__file__).with_name("plates.xml")
    sources["million"] = million.write(folder / "million")
    scenes = {}
    for name, source in sources.items():
        xml = re.sub(r'<rfilter type="[a-z]+"/>', '<rfilter type="box"/>', source.read_text())
        xml = re.sub(r"<sampler.*?</sampler>", "", xml, flags=re.S)
        scenes[name] = folder / name / "scene.xml"
        scenes[name].parent.mkdir(parents=True, exist_ok=True)
        scenes[name].write_text(xml)
        flat_scene.write(scenes[name], flat_file(scenes[name]))
    return scenes


def flat_file(scene: Path) -> Path:
    return scene.with_name("flat.npz")


def measured(name: str, images: np.ndarray, seconds: np.ndarray, reference: np.ndarray) -> Measured:
    mean = np.average(images, axis=0, weights=COUNTS)
    ratio = mean.mean((0, 1)) / reference.mean((0, 1))
    error = (mean - reference).std((0, 1)) / SIDE / reference.mean((0, 1))
    same = bool(np.all(np.abs(ratio - 1) < MEAN_TOLERANCE + 3 * error))
    return Measured(name, seconds.tolist(), [rel_mse(image, reference) for image in images], ratio.tolist(), same)


def of_peer(python: str, peer: str, scene: Path, reference: np.ndarray) -> list[Measured]:
    given, out = scene if reads_scene(peer) else flat_file(scene), scene.with_name(f"{peer}.npz")
    try:
        variants = run_peer(peer, python, given, (SIDE, SIDE), DEPTH, list(COUNTS), out)
    except PeerFailed as error:
        raise SystemExit(f"{peer} on {given} failed:\n{error}") from None
    return [measured(runs.name, runs.images, runs.seconds, reference) for runs in variants]


def of_scene(scene: Path, render: Render, pythons: dict[str, str]) -> list[Measured]:
    """Ours first, and of ours the one with goals of error."""
    reference, _ = render(scene, ("--spp", REFERENCE_SPP), 999)

    def ours(how: str, goals: list[tuple[str, float]]) -> Measured:
        runs = [render(scene, goal, seed) for seed, goal in enumerate(goals)]
        images, seconds = np.stack([image for image, _ in runs]), np.array([s for _, s in runs])
        return measured(f"{OURS}, {how}", images, seconds, reference)

    equal = ours("equal samples", [("--spp", spp) for spp in COUNTS])
    by_goal = ours("error goal", [("--rel-error", error**0.5) for error in equal.errors])
    peers = [row for peer, python in pythons.items() for row in of_peer(python, peer, scene, reference)]
    return [by_goal, equal, *peers]


def best_peer(rows: list[Measured]) -> Measured | None:
    peers = (row for row in rows if row.same_picture and not row.name.startswith(OURS))
    return min(peers, key=lambda row: row.cost, default=None)


def table(results: dict[str, list[Measured]], left_out: list[str]) -> str:
    """Markdown: each renderer at our error and in our time, and whether the aims are met."""
    heads = ["scene", "renderer", "seconds", "relMSE", "mean R G B to ours", "to our relMSE, s", "relMSE in our time"]
    lines = [
        f"Time to equal relMSE: {SIDE} x {SIDE} pixels, depth {DEPTH}, two threads. Seconds and relMSE at {COUNTS[-1]}",
        "samples a pixel or the goal of their error; the other columns from the 1 / time line through all points,",
        f"against {OURS} with error goals.",
        "",
        f"| {' | '.join(heads)} | our time to theirs |",
        "|---" * (len(heads) + 1) + "|",
    ]
    for scene, rows in results.items():
        error, seconds = rows[0].errors[-1], rows[0].seconds[-1]
        for row in rows:
            ratio = f"{rows[0].cost / row.cost:.2f}" if row.same_picture else "another picture"
            means = " ".join(f"{v:.3f}" for v in row.mean_ratio)
            lines.append(
                f"| {scene} | {row.name} | {row.seconds[-1]:.2f} | {row.errors[-1]:.3g} | {means} "
                f"| {row.cost / error:.2f} | {row.cost / seconds:.3g} | {ratio} |"
            )
    return "\n".join([*lines, "", *left_out, *verdicts(results)]) + "\n"


def verdicts(results: dict[str, list[Measured]]) -> list[str]:
    lines, ratios = [], []
    for scene, rows in results.items():
        best = best_peer(rows)
        if best is None:
            lines.append(f"- {scene}: no peer to compare with")
            continue
        ratios.append(rows[0].cost / best.cost)
        said = "pass" if ratios[-1] <= 1 else "miss"
        half = "pass" if ratios[-1] <= 0.5 else "miss"
        lines.append(f"- {scene}: {ratios[-1]:.2f} of the time of {best.name}: {said}; at most half: {half}")
    if ratios:
        halves = sum(ratio <= 0.5 for ratio in ratios)
        lines.append(f"- at most the best peer's time on each scene: {'pass' if max(ratios) <= 1 else 'miss'}")
        lines.append(f"- half of it on at least two: {'pass' if halves >= 2 else 'miss'} ({halves})")
    return lines


def plot(results: dict[str, list[Measured]]) -> str:
    """An SVG: relMSE over seconds, a colour a scene, dashes a renderer; of Mitsuba's samplers the best."""
    curves = []
    for scene, rows in results.items():
        shown: dict[str, Measured] = {}
        for row in sorted(rows, key=lambda row: row.cost):
            shown.setdefault(row.name.split(",")[0], row)
        for name, row in shown.items():
            points = list(zip(row.seconds, row.errors, strict=True))
            curves.append(Curve(points, f"{scene}: {row.name}", COLOURS[scene], DASHES[name]))
    return draw([Panel(curves, "time of rendering, seconds", "relMSE")])


def compare(folder: Path, render: Render) -> dict[str, list[Measured]]:
    """Measure all scenes; write peers.md and peers.svg into `folder`."""
    pythons = {peer: os.environ[name] for peer, name in PYTHONS.items() if name in os.environ}
    missing = [(name, peer) for peer, name in PYTHONS.items() if peer not in pythons]
    left_out = [f"- left out: {peer}, as {name} names no Python that has it" for name, peer in missing]
    work = folder / "peers"
    results = {name: of_scene(scene, render, pythons) for name, scene in write_scenes(work).items()}
    shutil.rmtree(work)
    text = table(results, left_out)
    (folder / "peers.md").write_text(text)
    (folder / "peers.svg").write_text(plot(results))
    print(text)
    return results
