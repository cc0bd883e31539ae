"""What a picture with an error goal will still need, is told within a factor of 1.5 from a fifth of its samples on.

Counted in samples, which no other load on the machine bends: after each look the engine reports what it expects to need
in all. The rounds to come double samples, so near the end a percent of error can decide on a whole round.

Known limit: where the error hangs on rare bright paths, as in veach-mis, its estimate rises while later samples find
them: 0.5 to 1.8 of the truth were seen there, and thousands of times too much after one bright sample among few.
"""

import json
from pathlib import Path

import pytest
from conftest import ROOT, outside_scene, render_alone

FACTOR = 1.5


def expected_and_naive(tmp_path: Path, scene: Path, size: str, goal: float, seed: int) -> list[tuple[float, float]]:
    """At each look from a fifth of the samples on: the expected samples over those that were taken in the end, and what
    the estimated error alone would expect, if it falls with the root of the samples."""
    report = tmp_path / "report.json"
    options = ("--size", size, "--rel-error", goal, "--seed", seed, "--report", report)
    render_alone(scene, tmp_path / "image.exr", *options)
    timeline = json.loads(report.read_text())["timeline"]
    final = timeline[-1]["spp"]
    assert timeline[-1]["expected_spp"] == pytest.approx(final)
    looks = [point for point in timeline[:-1] if point["expected_spp"] is not None and point["spp"] >= 0.2 * final]
    return [(look["expected_spp"] / final, look["spp"] * (look["error"] / goal) ** 2 / final) for look in looks]


def is_within(ratio: float) -> bool:
    return 1 / FACTOR <= ratio <= FACTOR


def test_samples_left_are_told_from_a_fifth_on(tmp_path: Path) -> None:
    looks = []
    for name, size, goal in (("cornell", "128x128", 0.1), ("cornell", "128x128", 0.05), ("furnace", "64x64", 0.02)):
        looks += expected_and_naive(tmp_path, ROOT / "scenes" / name / "scene.xml", size, goal, 0)
    assert len(looks) >= 6
    assert all(is_within(expected) for expected, _ in looks), looks
    # Twin: without the rounds and the confidence that the rule asks for, it is missed.
    assert not all(is_within(naive) for _, naive in looks), looks


@pytest.mark.slow
@pytest.mark.timeout(3600)
@pytest.mark.parametrize(
    ("name", "size", "goal"),
    [
        ("cornell", "384x384", 0.05),
        ("cornell", "128x128", 0.1),
        ("cornell", "96x96", 0.02),
        ("cornell-glass", "128x128", 0.1),
        ("cornell-glass", "96x96", 0.05),
        ("furnace", "64x64", 0.005),
        ("cornell-box", "192x192", 0.05),
        ("cornell-box", "96x96", 0.02),
    ],
)
def test_samples_left_are_told_on_many_scenes(name: str, size: str, goal: float, tmp_path: Path) -> None:
    own = ROOT / "scenes" / name / "scene.xml"
    scene = own if own.exists() else outside_scene(name)
    looks = [look for seed in range(4) for look in expected_and_naive(tmp_path, scene, size, goal, seed)]
    ratios = [expected for expected, _ in looks]
    print(f"{name} {size} at {goal}: {len(ratios)} looks, {min(ratios):.2f} to {max(ratios):.2f} of the samples needed")
    assert all(is_within(ratio) for ratio in ratios), ratios
