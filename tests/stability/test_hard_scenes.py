"""Catalogue 4.8: where path tracing is known to fail, a picture either keeps the error that was asked for or does not
claim it. Light that no path can find is reported by the audit from the side of the light (`error.unseen`)."""

import json
import sys
from dataclasses import dataclass
from pathlib import Path

import hard_scenes
import numpy as np
import pytest
from hard_scenes import Node

sys.path.insert(0, str(Path(__file__).parents[1] / "render"))

from conftest import beauty, outside_scene, relative_error, render_alone

SEEDS = 8


@dataclass
class Job:
    image: np.ndarray
    claimed: bool
    unseen: float | None
    warnings: list[str]


def run(scene: Node, folder: Path, *options: object) -> Job:
    file, report = folder / "scene.json", folder / "report.json"
    file.write_text(json.dumps(scene))
    image = beauty(render_alone(file, folder / "image.exr", *options, "--report", report))
    said = json.loads(report.read_text())
    claimed = not any(warning.startswith("goal not reached") for warning in said["warnings"])
    return Job(image, claimed, said["error"]["unseen"], said["warnings"])


@dataclass
class Claims:
    """Of eight seeds."""

    made: int
    wrong: int


def claims(scene: Node, truth: np.ndarray, goal: float, folder: Path) -> Claims:
    jobs = [run(scene, folder, "--rel-error", goal, "--seed", seed) for seed in range(SEEDS)]
    errors = [relative_error(job.image, truth) for job in jobs]
    print("claimed:", [job.claimed for job in jobs], "true errors:", [f"{error:.3f}" for error in errors])
    wrong = sum(job.claimed and error > goal for job, error in zip(jobs, errors, strict=True))
    return Claims(sum(job.claimed for job in jobs), wrong)


@pytest.mark.parametrize("name", ["bulb", "bulb_beside_a_lamp", "bulb_in_a_mirror"])
def test_a_point_light_in_glass_is_reported_and_not_claimed(name: str, tmp_path: Path) -> None:
    goal = 0.1
    job = run(getattr(hard_scenes, name)(), tmp_path, "--rel-error", goal)
    assert not job.claimed
    assert job.unseen is not None and job.unseen > 0.5
    assert any("cannot find" in warning for warning in job.warnings)
    # The lamp in its place without the glass: the light that is missing.
    scene = getattr(hard_scenes, name)()
    del scene["bulb"]
    free = run(scene, tmp_path, "--rel-error", goal)
    assert free.unseen is not None and free.unseen < 0.5 * job.unseen
    assert relative_error(job.image, free.image) > goal
    # A mirror throws light of a point lamp, too, that no path finds.
    assert free.claimed == ("mirror" not in scene)


def test_paths_do_not_claim_a_pool(tmp_path: Path) -> None:
    """Its caustic, 59 % of the error, is seen through the water alone; the samples of paths agree without it."""
    image, report = tmp_path / "image.exr", tmp_path / "report.json"
    goal = ("--size", "96x54", "--rel-error", 0.05, "--integrator", "path")
    render_alone(outside_scene("water-caustic"), image, *goal, "--report", report)
    said = json.loads(report.read_text())
    assert said["error"]["noise"] < 0.05
    assert said["error"]["unseen"] > 0.5
    assert any("ask for integrator photon-progressive" in warning for warning in said["warnings"])


def test_a_bulb_that_cannot_be_audited_is_not_claimed(tmp_path: Path) -> None:
    job = run(hard_scenes.bulb_near_fog(), tmp_path, "--rel-error", 0.1)
    assert not job.claimed
    assert job.unseen is None
    # Twin: without glass the same scene is claimed, with a word on what the claim rests on.
    scene = hard_scenes.bulb_near_fog()
    del scene["bulb"]
    free = run(scene, tmp_path, "--rel-error", 0.3)
    assert free.claimed
    assert any("noise alone" in warning for warning in free.warnings)


def test_truncated_paths_lose_the_light_that_they_should(tmp_path: Path) -> None:
    """Twin of the goal: a white room cut at n reflections has lost rho^(n + 1) of its light, and says nothing of it."""
    albedo, reflections = 0.99, 8
    job = run(hard_scenes.white_sphere(albedo, reflections + 1), tmp_path, "--rel-error", 0.05)
    truth = hard_scenes.white_sphere_radiance(albedo, reflections)
    assert job.claimed
    assert abs(job.image.mean() / truth - 1) < 0.02
    assert truth < 0.1 * hard_scenes.white_sphere_radiance(albedo)


@pytest.mark.slow
@pytest.mark.timeout(3600)
def test_a_white_room_keeps_its_goal(tmp_path: Path) -> None:
    albedo = 0.99
    truth = np.full((hard_scenes.SIDE, hard_scenes.SIDE, 3), hard_scenes.white_sphere_radiance(albedo))
    found = claims(hard_scenes.white_sphere(albedo), truth, 0.1, tmp_path)
    assert found.made == SEEDS, "an engine that always refuses keeps nothing"
    assert found.wrong <= 2


# Eight seeds at 95 %: three or more wrong claims happen once in 170 runs of a right bound. An engine that always
# refuses makes none, so nearly all have to be made.
@pytest.mark.slow
@pytest.mark.timeout(3600)
@pytest.mark.parametrize(
    ("name", "goal", "reference_spp"),
    [
        ("keyhole", 0.3, 16384),
        ("ten_thousand_lights", 0.1, 4096),
        ("peaked_fog", 0.2, 8192),
        ("hidden_bright_lamp", 0.2, 8192),
    ],
)
def test_hard_scenes_keep_their_goal(name: str, goal: float, reference_spp: int, tmp_path: Path) -> None:
    scene = getattr(hard_scenes, name)()
    truth = run(scene, tmp_path, "--spp", reference_spp, "--seed", 10_000).image
    found = claims(scene, truth, goal, tmp_path)
    assert found.made >= SEEDS - 1
    assert found.wrong <= 2
