"""Other renderers on a scene: as many samples as fit each budget, by the time that a first few samples took."""

import tempfile
from pathlib import Path

import numpy as np

from fluxfarm.chart.engine import Refused
from fluxfarm.chart.errors import flip, rel_mse
from fluxfarm.chart.images import Image
from fluxfarm.chart.options import ChartOptions
from fluxfarm.chart.scenes import ChartScene, path_depth
from fluxfarm.chart.series import Point, Series
from fluxfarm.peers import PYTHONS, flat_scene
from fluxfarm.peers.running import PeerFailed, PeerRuns, reads_scene, run_peer

PILOT = (4, 16)  # samples a pixel
MOST_SAMPLES = 1 << 16
MEAN_TOLERANCE = 0.01  # of each channel's mean, besides three standard errors


def measure_peer(
    peer: str, scene: ChartScene, reference: Image, options: ChartOptions
) -> tuple[Series, dict[int, Image]]:
    """The peer's runs, and by budget the picture of its first seed; of several variants the one that seems best.

    Raises Refused if there is no Python that has it, if it cannot read the scene, or if it draws another picture."""
    python = options.peers[peer]
    if python is None:
        raise Refused(f"{PYTHONS[peer]} names no Python that has it")
    height, width, _ = reference.shape
    with tempfile.TemporaryDirectory(prefix="fluxfarm-peer-") as folder:
        given, out = scene_for(peer, scene, Path(folder)), Path(folder) / "runs.npz"

        def run(counts: list[int], *variant: str) -> list[PeerRuns]:
            try:
                return run_peer(peer, python, given, (width, height), path_depth(scene), counts, out, *variant)
            except PeerFailed as error:
                raise Refused(str(error).splitlines()[-1]) from None

        best = min(run(list(PILOT)), key=lambda runs: _cost(runs, reference))
        sample_seconds = float(best.seconds[-1]) / PILOT[-1]
        counts = [min(MOST_SAMPLES, max(1, round(budget / sample_seconds))) for budget in options.budgets()]
        variant = best.name.split(", ")[1:]
        (runs,) = run(counts * options.seeds, *variant)
    check_same_picture(runs.images, counts * options.seeds, reference)
    points, pictures = [], {}
    for index, (image, seconds) in enumerate(zip(runs.images, runs.seconds, strict=True)):
        seed, budget = divmod(index, len(counts))
        errors = rel_mse(image, reference), flip(image, reference).mean
        points.append(Point(budget, seed, float(seconds), counts[budget], *errors))
        if seed == 0:
            pictures[budget] = image
    return Series(runs.name, points), pictures


def scene_for(peer: str, scene: ChartScene, folder: Path) -> Path:
    """The file that the peer reads: the scene, or what `folder` then holds of it as plain arrays."""
    if scene.path.suffix.lower() != ".xml":
        raise Refused("only XML scenes are given to other renderers")
    if reads_scene(peer):
        return scene.path
    flat = folder / "flat.npz"
    try:
        flat_scene.write(scene.path, flat)
    except (ValueError, LookupError, StopIteration, AssertionError) as error:
        raise Refused(f"the scene cannot be told to it: {error}") from None
    return flat


def check_same_picture(images: Image, counts: list[int], reference: Image) -> None:
    """Raise Refused if a channel's mean over all runs is not the reference's."""
    mean = np.average(images, axis=0, weights=counts)
    wanted = reference.mean((0, 1))
    ratio = mean.mean((0, 1)) / wanted
    error = (mean - reference).std((0, 1)) / np.sqrt(mean[..., 0].size) / wanted
    if not bool(np.all(np.abs(ratio - 1) < MEAN_TOLERANCE + 3 * error)):
        raise Refused(f"draws another picture: means of R, G, B {' '.join(f'{v:.3f}' for v in ratio)} of ours")


def _cost(runs: PeerRuns, reference: Image) -> float:
    """Seconds times relMSE, the same all along a line of error ~ 1 / time."""
    return float(np.mean([s * rel_mse(image, reference) for s, image in zip(runs.seconds, runs.images, strict=True)]))
