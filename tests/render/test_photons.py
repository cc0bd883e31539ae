"""Progressive photon mapping on `water-caustic`, where all light in the water comes through its surface.

Under the lamp as authored path tracing finds a tenth of that light. Under one of 40 times the sides and the same power
it converges, and both methods must agree.
"""

import shutil
from pathlib import Path

import numpy as np
import pytest
from conftest import beauty, outside_scene, relative_error, render_alone

SIZE = ("--size", "160x90")
SCALE = 40
BLOCK = 15
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


def runs(scene: Path, folder: Path, method: str, spp: int, seeds: int) -> np.ndarray:
    """Block means, (seeds, rows, columns, 3)."""
    images = [
        beauty(render_alone(scene, folder / "i.exr", *SIZE, "--integrator", method, "--spp", spp, "--seed", seed))
        for seed in range(seeds)
    ]
    return np.stack(images).reshape(seeds, 90 // BLOCK, BLOCK, 160 // 16, 16, 3).mean((2, 4))


@pytest.mark.slow
@pytest.mark.timeout(1200)
def test_photons_agree_with_paths_where_those_converge(tmp_path: Path) -> None:
    scene = under_a_larger_lamp(tmp_path)
    paths = runs(scene, tmp_path, "path", 512, 8)
    photons = runs(scene, tmp_path, "photon-progressive", 64, 8)
    difference = photons.mean(0) - paths.mean(0)
    error = np.sqrt(paths.var(0, ddof=1) / 8 + photons.var(0, ddof=1) / 8)
    print(f"mean {photons.mean() / paths.mean():.4f}, largest z {np.abs(difference / error).max():.2f}")
    assert photons.mean() == pytest.approx(paths.mean(), rel=0.01)
    # Of 180 Student variables of some 14 degrees of freedom the largest is beyond 6 with a probability of 0.6 %.
    assert np.abs(difference / error).max() < 6
    assert (np.abs(difference / error) > 4).mean() < 0.02
    # Twin: without the photons' part, as a path tracer that leaves caustics out.
    assert abs(0.9 * photons.mean() / paths.mean() - 1) > 0.01


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
