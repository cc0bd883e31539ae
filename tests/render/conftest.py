"""The real engine, alone and behind a real service."""

import os
import signal
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import OpenEXR
import pytest

sys.path.insert(0, str(Path(__file__).parents[1] / "service"))  # farm_client

if TYPE_CHECKING:
    from farm import Farm

ROOT = Path(__file__).parents[2]
ENGINE = Path(os.environ.get("FLUXFARM_ENGINE", Path(sys.executable).with_name("fluxfarm-engine")))
SCENES_DATA = Path(os.environ.get("FLUXFARM_SCENES_DATA", ROOT.parent / "shared" / "scenes-data"))

Layers = dict[str, np.ndarray]


def read_exr(path: Path) -> Layers:
    """Channels by their full names: (height, width) float32 over the data window."""
    with OpenEXR.File(str(path), separate_channels=True) as file:
        return {name: channel.pixels for name, channel in file.channels().items()}


def relative_error(image: np.ndarray, reference: np.ndarray) -> float:
    """Square root of relMSE, mean over pixels and channels of (I - R)^2 / (R^2 + 1e-2)."""
    return float(np.sqrt(((image - reference) ** 2 / (reference**2 + 1e-2)).mean()))


def beauty(layers: Layers) -> np.ndarray:
    """(height, width, 3) float64."""
    return np.stack([layers[c] for c in "RGB"], axis=-1).astype(np.float64)


def same_bits(a: Layers, b: Layers) -> bool:
    """Whether every channel agrees to the last bit."""
    return a.keys() == b.keys() and all(a[c].tobytes() == b[c].tobytes() for c in a)


def render_alone(scene: Path, out: Path, *options: object) -> Layers:
    """The layers of `fluxfarm-engine render` with these options."""
    subprocess.run([ENGINE, "render", scene, "-o", out, *map(str, options)], check=True)
    return read_exr(out)


def outside_scene(name: str, file: str = "scene.xml") -> Path:
    """A scene of the shared collection; skips the test where that is absent."""
    scene = SCENES_DATA / name / file
    if not scene.exists():
        pytest.skip(f"no outside scenes here: {scene} does not exist (set FLUXFARM_SCENES_DATA)")
    return scene


@pytest.fixture(scope="session", autouse=True)
def engine_is_built() -> None:
    if not ENGINE.exists():
        pytest.fail(f"{ENGINE} does not exist: make build")


@pytest.fixture
def farms() -> Iterator[list["Farm"]]:
    """Farms to end after the test."""
    started: list[Farm] = []
    yield started
    for farm in started:
        farm.service.end(signal.SIGTERM)
