"""Progressive photon mapping on `water-caustic`, where all light in the water comes through its surface.

Under the lamp as authored path tracing finds a tenth of that light. Under one of 40 times the sides and the same power
it converges, and both methods must agree.
"""

import shutil
from pathlib import Path

import numpy as np
import pytest
from conftest import Layers, beauty, outside_scene, relative_error, render_alone

SIZE = ("--size", "160x90")
SCALE = 40
BLOCK = (16, 15)
SEEDS = 32
# Matrix and radiance of the lamp, as authored and larger.
LAMP = [
    (
        "-0.0025 1.91069e-015 -4.37114e-008 -0.005 2.18557e-010 2.18557e-008 -0.5 1.98 "
        "0 -0.002 -8.74228e-011 -0.03 0 0 0 1",
        f"{-0.0025 * SCALE} 0 0 -0.005 0 0 -0.5 1.98 0 {-0.002 * SCALE} 0 -0.03 0 0 0 1",
    ),
    ("541127, 381972, 127324", ", ".join(str(v / SCALE**2) for v in (541127, 381972, 127324))),
]


def under_a_larger_lamp(folder: Path) -> Path:
    scene = outside_scene("water-caustic")
    copy = folder / "water-caustic"
    shutil.copytree(scene.parent, copy, copy_function=shutil.copyfile)
    text = scene.read_text()
    for authored, larger in LAMP:
        assert authored in text
        text = text.replace(authored, larger)
    (copy / "scene.xml").write_text(text)
    return copy / "scene.xml"


def blocks(layers: Layers, *prefixes: str) -> np.ndarray:
    """Mean over channels of those layers' sum in blocks, (rows, columns)."""
    light = np.sum([layers[prefix + c] for prefix in prefixes for c in "RGB"], axis=0, dtype=float) / 3
    return light.reshape(90 // BLOCK[1], BLOCK[1], 160 // BLOCK[0], BLOCK[0]).mean((1, 3))


def runs(scene: Path, folder: Path, method: str, spp: int) -> tuple[np.ndarray, np.ndarray]:
    """Blocks of all light and of that which came through the surface or is seen through it, (seeds, rows, columns)."""
    options = (*SIZE, "--integrator", method, "--spp", spp)
    images = [render_alone(scene, folder / "i.exr", *options, "--seed", seed) for seed in range(SEEDS)]
    through = [blocks(image, "caustic.", "specular.") for image in images]
    return np.stack([blocks(image, "") for image in images]), np.stack(through)


def agree(photons: np.ndarray, paths: np.ndarray) -> bool:
    """Whether the picture's mean agrees within 1 %, and each block within 4 standard errors.

    A block's difference over its standard error is a Student variable of 31 degrees of freedom or more, beyond 4 with a
    probability of 3.7e-4: of 60 blocks one is with 2.2 % at most.
    """
    error = np.sqrt((paths.var(0, ddof=1) + photons.var(0, ddof=1)) / SEEDS)
    z = np.abs(photons.mean(0) - paths.mean(0)) / error
    ratio = photons.mean() / paths.mean()
    print(f"mean {ratio:.4f}, largest z {z.max():.2f}, error of a block {np.median(error / paths.mean(0)):.2%}")
    return bool(abs(ratio - 1) < 0.01 and z.max() < 4)


@pytest.mark.slow
@pytest.mark.timeout(1800)
def test_photons_agree_with_paths_where_those_converge(tmp_path: Path) -> None:
    scene = under_a_larger_lamp(tmp_path)
    paths, _ = runs(scene, tmp_path, "path", 512)
    photons, through = runs(scene, tmp_path, "photon-progressive", 64)
    assert agree(photons, paths)
    assert not agree(photons - 0.05 * through, paths), "twin: a part of their caustics is missing"
    chequers = (-1) ** np.indices(photons.shape[1:]).sum(0)
    assert not agree(photons * (1 + 0.1 * chequers), paths), "twin: the mean is right, the blocks are not"


def test_photons_find_what_paths_do_not(tmp_path: Path) -> None:
    scene = outside_scene("water-caustic")
    options = (*SIZE, "--seconds", 4)
    photons = render_alone(scene, tmp_path / "photons.exr", *options, "--integrator", "photon-progressive")
    paths = render_alone(scene, tmp_path / "paths.exr", *options)
    reference = beauty(
        render_alone(scene, tmp_path / "r.exr", *SIZE, "--spp", 512, "--seed", 9, "--integrator", "photon-progressive")
    )
    errors = [relative_error(beauty(image), reference) for image in (photons, paths)]
    print(f"relative errors after 4 s: photons {errors[0]:.4f}, paths {errors[1]:.4f}")
    assert errors[0] < 0.15 * errors[1]
    # Twin: what paths find of it is nearly black but for a few bright samples.
    assert np.median(beauty(paths)) < 0.5 * np.median(reference)
