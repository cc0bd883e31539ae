"""What goes wrong must go wrong for one job only, and leave the same pixels."""

import os
import signal
import time
from collections.abc import Callable
from pathlib import Path

import pytest
from farm_client import Client, ServiceProcess

from fluxfarm.settings import Settings

SCENE = "fake: size 64 64\nfake: spp 16\nfake: tile_seconds 0.02\n"


def engine_pids(client: Client) -> list[int]:
    return [worker["pid"] for worker in client.http.get("/v1/workers").json()["workers"] if worker["pid"]]


def test_worker_killed_in_the_middle_of_a_pass_leaves_the_same_image(
    start: Callable[..., Client], tmp_path: Path
) -> None:
    undisturbed = start(data=tmp_path / "calm").render(SCENE)
    client = start(data=tmp_path / "wild", workers=2)
    job_id = client.submit(SCENE)
    for done in (8, 30):
        client.wait_until(job_id, lambda job, done=done: job["progress"]["tiles_done"] >= done)
        os.kill(engine_pids(client)[0], signal.SIGKILL)
    client.succeed(job_id)
    assert client.image_digest(job_id) == undisturbed
    assert sum(worker["restarts"] for worker in client.http.get("/v1/workers").json()["workers"]) >= 1


def test_scene_that_ends_three_processes_fails_while_another_job_goes_on(client: Client) -> None:
    bad = client.submit("fake: size 64 64\nfake: spp 8\nfake: crash_in_pass 2\n")
    good = client.submit(SCENE)
    job = client.finish(bad)
    assert job["state"] == "FAILED"
    assert "ended three engine processes" in job["reason"]
    assert "SIGKILL" in job["reason"]
    assert "about to crash, as told" in job["reason"]
    client.succeed(good)
    assert client.http.get("/v1/workers").json()["workers"][0]["restarts"] == 3


def scratch_files(settings: Settings) -> list[str]:
    return [path.name for path in (settings.data / "jobs").glob("*/scratch/*")]


def wait_until_scratch_is_empty(settings: Settings) -> None:
    end = time.monotonic() + 5
    while scratch_files(settings):
        assert time.monotonic() < end, f"left behind: {scratch_files(settings)}"
        time.sleep(0.02)


def test_single_crash_costs_nothing_but_time(client: Client, settings: Settings, tmp_path: Path) -> None:
    scene = f"fake: size 64 64\nfake: spp 8\nfake: crash_once {tmp_path / 'crashed'}\n"
    job = client.succeed(client.submit(scene))
    assert (tmp_path / "crashed").exists()
    assert job["progress"]["samples_done"] == 64 * 64 * 8
    wait_until_scratch_is_empty(settings)


@pytest.mark.parametrize("how", ["missing", "cut"])
def test_bad_tile_file_is_a_fault_of_its_lease_alone(
    how: str, client: Client, settings: Settings, tmp_path: Path
) -> None:
    twice = client.submit(SCENE + f"fake: damage {how} 2 {tmp_path / 'twice'}\n")
    always = client.submit(SCENE + f"fake: damage {how} 100 {tmp_path / 'always'}\n")
    good = client.submit(SCENE)
    client.succeed(twice)
    assert (tmp_path / "twice").read_bytes() == b"xx"
    assert client.image_digest(twice) == client.render(SCENE)
    job = client.finish(always)
    assert job["state"] == "FAILED"
    assert "ran out of resources three times: a tile could not be stored" in job["reason"]
    assert ("No such file" if how == "missing" else "bytes, but the engine process wrote") in job["reason"]
    client.succeed(good)
    assert client.http.get("/v1/workers").json()["workers"][0]["restarts"] == 0
    wait_until_scratch_is_empty(settings)


@pytest.mark.parametrize("verb", ["cancel", "pause"])
def test_stopped_job_leaves_no_files_of_its_leases(verb: str, client: Client, settings: Settings) -> None:
    job_id = client.submit(SCENE)
    client.wait_until(job_id, lambda job: job["progress"]["tiles_done"] >= 3)
    assert client.http.post(f"/v1/jobs/{job_id}:{verb}").status_code == 200
    client.render("fake: spp 1\n")  # what the engine process had begun is over
    wait_until_scratch_is_empty(settings)


def test_scene_fault_fails_the_job_at_once_with_the_engines_words(client: Client) -> None:
    words = "scene.xml:3: bsdf type = 'velvet', expected one of diffuse, plastic"
    job = client.finish(client.submit(f"fake: fail SCENE {words}\n"))
    assert (job["state"], job["reason"]) == ("FAILED", words)


def test_lack_of_resources_is_tried_again_but_not_for_ever(client: Client, tmp_path: Path) -> None:
    client.succeed(client.submit(f"fake: spp 2\nfake: run_out {tmp_path / 'twice'}\n"))
    assert (tmp_path / "twice").read_bytes() == b"xx"
    job = client.finish(client.submit("fake: fail RESOURCE out of memory: 8 GiB\n"))
    assert (job["state"], job["reason"]) == ("FAILED", "ran out of resources three times: out of memory: 8 GiB")


def test_process_without_progress_is_replaced_and_its_job_failed(start: Callable[..., Client]) -> None:
    client = start(stall_seconds=0.4)
    job = client.finish(client.submit("fake: spp 2\nfake: deaf\n"))
    assert job["state"] == "FAILED"
    assert "no sign of progress for 0.4 s" in job["reason"]


def test_frame_beyond_the_limit_and_crop_outside_it_fail_the_job(start: Callable[..., Client]) -> None:
    client = start(max_pixels=1000)
    job = client.finish(client.submit("fake: size 64 64\n"))
    assert (job["state"], job["reason"]) == ("FAILED", "size = 64x64: expected at most 1000 pixels")
    body = {"crop": {"x": 20, "y": 0, "width": 20, "height": 20}}
    job = client.finish(client.submit("fake: size 30 30\n", **body))
    assert job["state"] == "FAILED"
    assert "crop = 20,0 20x20" in job["reason"]


def gone(pid: int) -> bool:
    """Whether a process has ended (a zombie has)."""
    try:
        return Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()[0] == "Z"
    except FileNotFoundError:
        return True


def test_service_killed_and_restarted_ends_with_the_same_image(
    start: Callable[..., Client], settings: Settings, tmp_path: Path
) -> None:
    undisturbed = start(data=tmp_path / "calm").render(SCENE, seed=3)
    job_id, seen = "", []
    for done in (5, 25, 60):
        service = ServiceProcess(settings, workers=2)
        client = service.client
        assert client is not None
        job_id = job_id or client.submit(SCENE, seed=3)
        client.wait_until(job_id, lambda job, done=done: job["progress"]["tiles_done"] >= done)
        seen.append(client.job(job_id)["progress"]["tiles_done"])
        engines = engine_pids(client)
        service.end(signal.SIGKILL)
        end = time.monotonic() + 15  # one that is still starting notices only then
        while not all(gone(pid) for pid in engines):
            assert time.monotonic() < end, "an engine process outlived its service"
            time.sleep(0.02)
    service = ServiceProcess(settings, workers=1)
    assert service.client is not None
    job = service.client.succeed(job_id)
    assert service.client.image_digest(job_id) == undisturbed
    assert job["progress"]["tiles_done"] == 16 * 5
    events = service.client.events(job_id)
    assert [event["id"] for event in events] == list(range(1, len(events) + 1))
    assert sum(event["event"] == "tile" for event in events) == 16 * 5
    assert service.end(signal.SIGTERM) in (0, -signal.SIGTERM)
    assert seen == sorted(seen)


def test_second_service_on_the_same_data_is_refused(start: Callable[..., Client], settings: Settings) -> None:
    start()
    service = ServiceProcess(settings, workers=1)
    assert service.line == ""
    assert service.end(signal.SIGTERM) == 3


@pytest.mark.parametrize("state", ["PAUSED", "SUCCEEDED"])
def test_restart_leaves_nothing_behind_that_no_job_names(
    state: str, start: Callable[..., Client], settings: Settings, tmp_path: Path
) -> None:
    service = ServiceProcess(settings, workers=1)
    assert service.client is not None
    job_id = service.client.submit(SCENE)
    if state == "PAUSED":
        service.client.wait_until(job_id, lambda job: job["progress"]["tiles_done"] >= 3)
        service.client.http.post(f"/v1/jobs/{job_id}:pause")
    else:
        service.client.succeed(job_id)
    service.end(signal.SIGKILL)
    jobs = settings.data / "jobs"
    litter = [settings.data / "incoming" / "upload", jobs / job_id / "tiles" / ("0" * 64), jobs / "unknown"]
    litter.append(jobs / job_id / "scratch" / "1-0.tile")
    for path in litter:
        path.write_bytes(b"") if path.name != "unknown" else path.mkdir()
    client = start()
    assert client.job(job_id)["state"] == state
    assert not any(path.exists() for path in litter)
    if state == "PAUSED":
        client.http.post(f"/v1/jobs/{job_id}:resume")
    client.succeed(job_id)
    kept = {path.name for path in (jobs / job_id / "outputs").iterdir()}
    revisions = client.http.get(f"/v1/jobs/{job_id}/revisions").json()["revisions"]
    assert {revision["sha256"] for revision in revisions} <= kept
    assert not list((jobs / job_id / "tiles").iterdir())
