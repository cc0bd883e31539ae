"""Real scenes from outside against Mitsuba 3, block by block of 16 x 16 pixels.

References are the block means of long Mitsuba runs with equal depth and their standard errors (make_reference.py). All
blocks and channels together reject a right picture with a probability of 1 % (Sidak). veach-bidir has heavy tails
(light that reaches a diffuse surface by way of glass): there the medians over the runs are compared, with errors from
the median absolute deviation. veach-mis has some, too (by way of its sharpest mirror, about one bright sample in 10^5),
so that its means need many samples in all before their errors can be believed.

veach-ajar, glass-of-milk and gltf-cornell-glass are noisy everywhere: their whole pictures are compared, too, where a
wrong brightness shows that the blocks would hide.
"""

import json
import shutil
from dataclasses import dataclass
from pathlib import Path
from statistics import NormalDist

import numpy as np
import pytest
from conftest import beauty, outside_scene, render_alone
from outside_variants import as_compared

REFERENCES = Path(__file__).parent / "references"
NOISY = [("glass-of-milk", 16), ("gltf-cornell-glass", 16), ("veach-ajar", 32)]  # samples a pixel and run
MAX_Z = 4.0


@dataclass(frozen=True)
class Runs:
    """Images of several seeds. `blocks`: (runs, rows, columns, 3) float64."""

    reference: dict
    blocks: np.ndarray


def scene_as_compared(name: str, tmp_path: Path) -> Path:
    """The scene that the reference is of: as it stands, or a changed copy."""
    if name == "gltf-cornell-glass":
        return outside_scene(name, "scene.glb")
    scene = outside_scene(name)
    xml = scene.read_text()
    if as_compared(name, xml) == xml:
        return scene
    copy = tmp_path / name
    shutil.copytree(scene.parent, copy, copy_function=shutil.copyfile)
    (copy / "scene.xml").write_text(as_compared(name, xml))
    return copy / "scene.xml"


def render_runs(name: str, tmp_path: Path, runs: int, spp: int) -> Runs:
    reference = json.loads((REFERENCES / f"{name}.json").read_text())
    scene, block = scene_as_compared(name, tmp_path), reference["block"]
    width, height = reference["width"], reference["height"]
    images = []
    for seed in range(runs):
        options = ("--size", f"{width}x{height}", "--spp", spp, "--seed", seed + 1, "--integrator", "path")
        images.append(beauty(render_alone(scene, tmp_path / "image.exr", *options)))
    shape = (runs, height // block, block, width // block, block, 3)
    return Runs(reference, np.stack(images).reshape(shape).mean((2, 4)))


def z_scores(runs: Runs, statistic: str, scale: float = 1) -> np.ndarray:
    """Difference of each block to the reference over both standard errors together. statistic: mean or median."""
    count = len(runs.blocks)
    if statistic == "mean":
        ours, error = runs.blocks.mean(0), runs.blocks.std(0, ddof=1) / np.sqrt(count)
    else:
        ours = np.median(runs.blocks, 0)
        robust_sd = 1.4826 * np.median(np.abs(runs.blocks - ours), 0)
        error = np.sqrt(np.pi / 2) * robust_sd / np.sqrt(count)
    theirs = np.array(runs.reference[f"{statistic}s"])
    both = np.hypot(error, np.array(runs.reference[f"{statistic}_errors"]))
    # A block that only shows a lamp has no error on either side: float rounding is no difference.
    both = np.maximum(both, 2e-6 * np.abs(theirs))
    return np.abs(scale * ours - theirs) / both


def picture_z_scores(runs: Runs, scale: float = 1) -> np.ndarray:
    """(3,) difference of each channel's mean to the reference over both standard errors together."""
    ours = runs.blocks.mean((1, 2))
    error = ours.std(0, ddof=1) / np.sqrt(len(ours))
    block_errors = np.array(runs.reference["mean_errors"])
    reference_error = np.sqrt((block_errors**2).sum((0, 1))) / (block_errors.shape[0] * block_errors.shape[1])
    difference = scale * ours.mean(0) - np.array(runs.reference["means"]).mean((0, 1))
    return np.abs(difference) / np.hypot(error, reference_error)


def allowed_outliers(count: int) -> int:
    """How many of `count` right blocks may lie beyond MAX_Z: exceeded with a probability below 1 %."""
    expected = count * 2 * (1 - NormalDist().cdf(MAX_Z))
    return 0 if expected < 0.01 else 1 if expected < 0.15 else 2


def report(name: str, z: np.ndarray) -> str:
    beyond = int((z > MAX_Z).sum())
    rms = np.sqrt((z**2).mean())
    return (
        f"{name}: {z.size} blocks and channels, largest z {z.max():.2f}, root mean square {rms:.2f}, {beyond} beyond 4"
    )


@pytest.mark.parametrize(("name", "runs", "spp"), [("cornell-box", 12, 16), ("veach-mis", 12, 16)])
def test_block_means_agree_with_mitsuba(name: str, runs: int, spp: int, tmp_path: Path) -> None:
    rendered = render_runs(name, tmp_path, runs, spp)
    z = z_scores(rendered, "mean")
    # Few runs: the errors themselves are uncertain, as Student's t with runs - 1 degrees of freedom; 4 becomes 7.
    assert z.max() <= 7, report(name, z)
    ratio = rendered.blocks.mean((0, 1, 2)) / np.array(rendered.reference["image_mean"])
    assert np.all(np.abs(ratio - 1) < 0.005), f"{name}: channel means are {ratio} of Mitsuba's"


def test_picture_two_percent_too_bright_does_not_agree(tmp_path: Path) -> None:
    rendered = render_runs("cornell-box", tmp_path, 12, 16)
    assert z_scores(rendered, "mean", scale=1.02).max() > 7


@pytest.mark.parametrize(("name", "spp"), NOISY)
def test_noisy_scene_agrees_with_mitsuba_and_not_if_five_percent_too_bright(
    name: str, spp: int, tmp_path: Path
) -> None:
    rendered = render_runs(name, tmp_path, 12, spp)
    z = z_scores(rendered, "mean")
    assert z.max() <= 7, report(name, z)  # as above, with 11 degrees of freedom
    assert picture_z_scores(rendered).max() <= MAX_Z, picture_z_scores(rendered)
    assert picture_z_scores(rendered, scale=1.05).max() > MAX_Z


def test_cornell_box_has_the_published_means(tmp_path: Path) -> None:
    options = ("--size", "256x256", "--spp", 1024)
    image = beauty(render_alone(outside_scene("cornell-box"), tmp_path / "image.exr", *options))
    assert image.mean((0, 1)) == pytest.approx([0.1964, 0.1276, 0.0362], rel=0.005)


@pytest.mark.slow
@pytest.mark.timeout(3600)
@pytest.mark.parametrize(
    ("name", "statistic", "runs", "spp"),
    [
        ("cornell-box", "mean", 32, 128),
        ("veach-mis", "mean", 32, 512),
        ("veach-bidir", "median", 32, 512),
        ("glass-of-milk", "mean", 32, 128),
        ("gltf-cornell-glass", "mean", 32, 128),
        ("veach-ajar", "mean", 32, 128),
    ],
)
def test_all_blocks_agree_with_mitsuba_within_four_errors(
    name: str, statistic: str, runs: int, spp: int, tmp_path: Path
) -> None:
    rendered = render_runs(name, tmp_path, runs, spp)
    z = z_scores(rendered, statistic)
    print(report(name, z))
    assert int((z > MAX_Z).sum()) <= allowed_outliers(z.size), report(name, z)
    if name in dict(NOISY):
        assert picture_z_scores(rendered).max() <= MAX_Z, picture_z_scores(rendered)
        assert picture_z_scores(rendered, scale=1.02).max() > MAX_Z, "2 % too bright went unseen"
