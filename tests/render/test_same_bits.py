"""Promise 1: the same job gives the same pixels to the bit, whoever renders it and whatever happens on the way."""

import os
import signal
import subprocess
import time
from pathlib import Path

import numpy as np
import pytest
from conftest import ENGINE, ROOT, Layers, read_exr, render_alone, same_bits
from farm import SCENE, SEED, SIDE, SPP, Farm

# What "auto" is to choose: scene, goal, method.
AUTO = [
    ("cornell", {"rel_error": 0.06}, "irradiance-cache"),
    ("cornell-glass", {"spp": 16}, "irradiance-cache"),
]


@pytest.fixture(scope="module")
def alone(tmp_path_factory: pytest.TempPathFactory) -> Layers:
    """What the engine alone makes of the job."""
    out = tmp_path_factory.mktemp("alone") / "alone.exr"
    return render_alone(SCENE, out, "--size", f"{SIDE}x{SIDE}", "--spp", SPP, "--seed", SEED)


def test_one_worker_with_one_thread_gives_the_bits_of_the_engine_alone(
    farms: list[Farm], tmp_path: Path, alone: Layers
) -> None:
    farms.append(Farm(tmp_path))
    assert same_bits(alone, farms[0].layers(farms[0].submit()))


@pytest.mark.parametrize("tile_size", [16, 32, 64])
def test_two_workers_and_any_tile_size_give_the_same_bits(
    farms: list[Farm], tmp_path: Path, alone: Layers, tile_size: int
) -> None:
    farms.append(Farm(tmp_path, tile_size=tile_size, workers=2))
    assert same_bits(alone, farms[0].layers(farms[0].submit()))


def test_worker_killed_in_the_middle_of_a_pass_gives_the_same_bits(
    farms: list[Farm], tmp_path: Path, alone: Layers
) -> None:
    farms.append(farm := Farm(tmp_path, workers=2))
    job_id = farm.submit()
    for tiles in (40, 150):
        farm.wait_for_tiles(job_id, tiles)
        os.kill(farm.engine_pids()[0], signal.SIGKILL)
    assert same_bits(alone, farm.layers(job_id))
    assert sum(worker["restarts"] for worker in farm.client.http.get("/v1/workers").json()["workers"]) >= 1


def test_service_killed_and_started_again_gives_the_same_bits(farms: list[Farm], tmp_path: Path, alone: Layers) -> None:
    farms.append(farm := Farm(tmp_path, workers=2))
    job_id = farm.submit()
    for tiles in (50, 180):
        farm.wait_for_tiles(job_id, tiles)
        farm.service.end(signal.SIGKILL)
        farm.start()
        assert farm.tiles_done(job_id) >= tiles, "a tile that was reported done is lost"
    assert same_bits(alone, farm.layers(job_id))


def test_error_goal_gives_the_same_bits_whoever_renders_it(farms: list[Farm], tmp_path: Path) -> None:
    scene, goal = ROOT / "scenes" / "cornell" / "scene.xml", 0.1
    options = ("--size", f"{SIDE}x{SIDE}", "--rel-error", goal, "--seed", SEED, "--tile", 16)
    alone = render_alone(scene, tmp_path / "alone.exr", *options)
    assert len(np.unique(alone["samples"])) > 1, "all tiles took the same samples: nothing was decided"
    farms.append(farm := Farm(tmp_path, workers=2))
    job_id = farm.submit(scene, {"rel_error": goal})
    for tiles in (20, 50):
        farm.wait_for_tiles(job_id, tiles)
        farm.service.end(signal.SIGKILL)
        farm.start()
    assert same_bits(alone, farm.layers(job_id))


@pytest.mark.parametrize("method", ["photon", "photon-progressive", "irradiance-cache"])
def test_prepared_passes_give_the_same_bits_whoever_makes_them(farms: list[Farm], tmp_path: Path, method: str) -> None:
    scene = ROOT / "scenes" / "cornell-glass" / "scene.xml"
    options = ("--size", f"{SIDE}x{SIDE}", "--spp", SPP, "--seed", SEED, "--integrator", method)
    alone = render_alone(scene, tmp_path / "alone.exr", *options)
    assert alone["error.bias"].max() > 0
    farms.append(farm := Farm(tmp_path, workers=2, tile_size=32))
    job_id = farm.submit(scene, integrator=method)
    farm.wait_for_tiles(job_id, 20)
    os.kill(farm.engine_pids()[0], signal.SIGKILL)
    farm.wait_for_tiles(job_id, 50)
    farm.service.end(signal.SIGKILL)
    farm.start()
    assert same_bits(alone, farm.layers(job_id))
    report = farm.client.http.get(f"/v1/jobs/{job_id}/report").json()
    assert report["integrator"] == method
    assert 0 < report["error"]["bias"] < 0.2


@pytest.mark.parametrize(("scene", "goal", "method"), AUTO)
def test_chosen_method_is_the_same_whoever_chooses_it(
    farms: list[Farm], tmp_path: Path, scene: str, goal: dict[str, float], method: str
) -> None:
    """The second worker renders by the method that the first one's pilot chose, and so does a service started anew."""
    path = ROOT / "scenes" / scene / "scene.xml"
    (option,) = (("--" + name.replace("_", "-"), value) for name, value in goal.items())
    options = ("--size", f"{SIDE}x{SIDE}", *option, "--seed", SEED, "--integrator", "auto", "--tile", 16)
    alone = render_alone(path, tmp_path / "alone.exr", *options)
    farms.append(farm := Farm(tmp_path, workers=2))
    job_id = farm.submit(path, goal, integrator="auto")
    farm.wait_for_tiles(job_id, 12)
    farm.service.end(signal.SIGKILL)
    farm.start()
    assert same_bits(alone, farm.layers(job_id))
    plan = farm.client.http.get(f"/v1/jobs/{job_id}/plan").json()
    assert (plan["integrator"], farm.client.job(job_id)["integrator"]) == (method, method)
    assert plan["choice"]["goal"] == goal
    assert "times as much" in plan["choice"]["reason"]
    tried = [known["method"] for known in plan["choice"]["methods"] if known["tried"]]
    assert {"path", method} <= set(tried)


@pytest.mark.parametrize(("tile_size", "workers"), [(16, 4), (64, 1)])
def test_irradiance_cache_gives_the_same_bits_for_any_tiles_and_workers(
    farms: list[Farm], tmp_path: Path, tile_size: int, workers: int
) -> None:
    """Each worker makes the caches anew; tiles come to them in the order in which they are free."""
    scene, method = ROOT / "scenes" / "cornell" / "scene.xml", "irradiance-cache"
    options = ("--size", f"{SIDE}x{SIDE}", "--spp", SPP, "--seed", SEED, "--integrator", method)
    alone = render_alone(scene, tmp_path / "alone.exr", *options)
    farms.append(farm := Farm(tmp_path, tile_size=tile_size, workers=workers))
    assert same_bits(alone, farm.layers(farm.submit(scene, integrator=method)))


def test_pause_and_resume_give_the_same_bits(farms: list[Farm], tmp_path: Path, alone: Layers) -> None:
    farms.append(farm := Farm(tmp_path))
    job_id = farm.submit()
    farm.wait_for_tiles(job_id, 60)
    assert farm.client.http.post(f"/v1/jobs/{job_id}:pause").status_code == 200
    time.sleep(1)
    paused = farm.tiles_done(job_id)
    time.sleep(1)
    assert farm.tiles_done(job_id) == paused, "a paused job goes on"
    assert farm.client.http.post(f"/v1/jobs/{job_id}:resume").status_code == 200
    assert same_bits(alone, farm.layers(job_id))


def test_tile_image_is_the_same_part_of_the_frame(farms: list[Farm], tmp_path: Path, alone: Layers) -> None:
    farms.append(farm := Farm(tmp_path, tile_size=32))
    job_id = farm.submit()
    farm.client.succeed(job_id)
    tile = tmp_path / "tile.exr"
    tile.write_bytes(farm.client.http.get(f"/v1/jobs/{job_id}/tiles/2-1.exr").content)
    assert np.array_equal(read_exr(tile)["R"], alone["R"][32:64, 64:96])


def test_command_line_gives_the_bits_of_the_engine_alone(tmp_path: Path, alone: Layers) -> None:
    out = tmp_path / "out.exr"
    command = [ENGINE.with_name("fluxfarm"), "render", SCENE, "-o", out]
    options = ["--size", f"{SIDE}x{SIDE}", "--spp", str(SPP), "--seed", str(SEED)]
    subprocess.run([*command, *options], check=True, capture_output=True)
    assert same_bits(alone, read_exr(out))


def test_another_seed_gives_other_bits(tmp_path: Path, alone: Layers) -> None:
    other = render_alone(SCENE, tmp_path / "o.exr", "--size", f"{SIDE}x{SIDE}", "--spp", SPP, "--seed", SEED + 1)
    assert not same_bits(alone, other)
