"""The picture to compare with: given, or a long run that is kept in the chart's folder for the next time."""

import hashlib
import json
import shutil
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from fluxfarm.chart.engine import Engine, run_seconds
from fluxfarm.chart.images import Image, read_channels, read_exr
from fluxfarm.chart.options import ChartOptions
from fluxfarm.chart.scenes import ChartScene
from fluxfarm.errors import ChartError

# Path tracing wherever nothing is glossy, bit by bit; else photons carry what paths find too rarely for a reference.
METHOD = "photon-progressive"
SEED = 1 << 32  # no measured run has it


@dataclass(frozen=True, slots=True)
class Reference:
    """`rel_mse` is its own, as far as it is known: claimed by the run that made it, or by the image's error.noise."""

    image: Image
    rel_mse: float | None
    origin: str

    @property
    def size(self) -> tuple[int, int]:
        """Width and height in pixels."""
        height, width, _ = self.image.shape
        return width, height


def find_reference(scene: ChartScene, engine: Engine, options: ChartOptions) -> Reference:
    """The given image, the one of an earlier chart, or a new one; raises engine.Refused if it cannot be rendered."""
    if options.reference is not None:
        return _given(options.reference, options.size)
    key = [scene.digest(), engine.build(), METHOD, options.reference_spp, options.size]
    name = f"{scene.name}-{hashlib.sha256(json.dumps(key).encode()).hexdigest()[:12]}"
    folder = options.out / "references"
    image, told = folder / f"{name}.exr", folder / f"{name}.json"
    if not (image.exists() and told.exists()):
        folder.mkdir(parents=True, exist_ok=True)
        goal = ("--integrator", METHOD, "--spp", options.reference_spp, "--seed", SEED)
        run = engine.render(scene.path, options.size, *goal)
        shutil.move(engine.image, image)
        told.write_text(json.dumps(run.report, indent=2) + "\n")
    report = json.loads(told.read_text())
    origin = f"{METHOD}, {options.reference_spp} samples a pixel, {run_seconds(report):.0f} s"
    return Reference(read_exr(image), claimed_rel_mse(report["error"]), origin)


def claimed_rel_mse(error: dict[str, float | None]) -> float | None:
    """relMSE by noise, bias and unseen light together; what is not known of the latter two is left out. None where
    the noise is not known."""
    if error["noise"] is None:
        return None
    return float(sum(value**2 for value in error.values() if value is not None))


def _given(path: Path, size: tuple[int, int] | None) -> Reference:
    channels = read_channels(path)
    image = np.stack([channels[name] for name in "RGB"], axis=-1).astype(np.float64)
    height, width, _ = image.shape
    if size is not None and size != (width, height):
        raise ChartError(f"--reference = {path}: {width}x{height} pixels, expected --size {size[0]}x{size[1]}")
    own = None
    if "error.noise" in channels:
        luminance = image @ (0.2126, 0.7152, 0.0722)
        own = float(np.mean(channels["error.noise"].astype(np.float64) ** 2 / (luminance**2 + 1e-2)))
    return Reference(image, own, path.name)
