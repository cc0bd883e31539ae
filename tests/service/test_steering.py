"""Commands of a job's owner."""

import time
from collections.abc import Callable
from pathlib import Path

import pytest
from farm_client import Client

SLOW = "fake: size 64 64\nfake: spp 64\nfake: tile_seconds 0.05\n"


def busy_workers(client: Client) -> int:
    return sum(bool(worker["jobs"]) for worker in client.http.get("/v1/workers").json()["workers"])


@pytest.mark.parametrize("scene", [SLOW, "fake: spp 4\nfake: deaf\n"], ids=["hears", "deaf"])
def test_cancelled_job_commits_nothing_more_and_its_workers_stop_in_two_seconds(client: Client, scene: str) -> None:
    job_id = client.submit(scene)
    client.wait_until(job_id, lambda job: job["state"] == "RUNNING" and busy_workers(client) > 0)
    if scene is SLOW:
        client.wait_until(job_id, lambda job: job["progress"]["tiles_done"] >= 20)
    cancelled = client.http.post(f"/v1/jobs/{job_id}:cancel").json()
    stopped_at = time.monotonic()
    assert cancelled["state"] == "CANCELLED"
    while busy_workers(client):
        assert time.monotonic() - stopped_at < 2
        time.sleep(0.02)
    time.sleep(0.3)
    assert client.job(job_id)["progress"]["tiles_done"] == cancelled["progress"]["tiles_done"]
    assert client.events(job_id)[-1]["data"]["state"] == "CANCELLED"
    assert client.http.post(f"/v1/jobs/{job_id}:cancel").status_code == 200
    client.succeed(client.submit("fake: spp 2\n"))


def test_paused_and_resumed_job_gives_the_same_image(start: Callable[..., Client], tmp_path: Path) -> None:
    scene = "fake: size 64 64\nfake: spp 16\nfake: tile_seconds 0.01\n"
    undisturbed = start(data=tmp_path / "calm").render(scene)
    client = start(data=tmp_path / "paused")
    job_id = client.submit(scene)
    for done in (4, 20):
        client.wait_until(job_id, lambda job, done=done: job["progress"]["tiles_done"] >= done)
        paused = client.http.post(f"/v1/jobs/{job_id}:pause").json()
        assert paused["state"] == "PAUSED"
        time.sleep(0.2)
        assert client.job(job_id)["progress"]["tiles_done"] == paused["progress"]["tiles_done"]
        assert client.http.post(f"/v1/jobs/{job_id}:resume").json()["state"] == "RUNNING"
    client.succeed(job_id)
    assert client.image_digest(job_id) == undisturbed


def test_job_paused_before_its_turn_waits(client: Client) -> None:
    first = client.submit(SLOW)
    second = client.submit("fake: spp 2\n")
    assert client.http.post(f"/v1/jobs/{second}:pause").json()["state"] == "PAUSED"
    client.http.post(f"/v1/jobs/{first}:cancel")
    time.sleep(0.3)
    assert client.job(second)["state"] == "PAUSED"
    assert client.http.post(f"/v1/jobs/{second}:resume").json()["state"] == "QUEUED"
    client.succeed(second)


def test_commands_that_the_state_forbids_are_conflicts(client: Client) -> None:
    job_id = client.submit("fake: spp 1\n")
    client.succeed(job_id)
    for command in ("cancel", "pause", "resume"):
        reply = client.http.post(f"/v1/jobs/{job_id}:{command}")
        assert reply.status_code == 409, reply.text
        assert reply.json()["type"] == "urn:fluxfarm:problem:illegal-transition"
        assert "SUCCEEDED" in reply.json()["detail"]


def test_deleted_job_is_gone_with_its_files(client: Client, tmp_path: Path) -> None:
    done, running = client.submit("fake: spp 1\n"), client.submit(SLOW)
    client.succeed(done)
    for job_id in (done, running):
        assert client.http.delete(f"/v1/jobs/{job_id}").status_code == 204
        reply = client.http.get(f"/v1/jobs/{job_id}")
        assert (reply.status_code, reply.json()["type"]) == (410, "urn:fluxfarm:problem:gone")
        assert not (tmp_path / "data" / "jobs" / job_id / "outputs").exists()


def test_higher_priority_goes_first(client: Client) -> None:
    client.submit("fake: spp 16\nfake: tile_seconds 0.02\n")
    low = client.submit("fake: spp 8\nfake: tile_seconds 0.01\n", priority=-1)
    high = client.submit("fake: spp 8\nfake: tile_seconds 0.01\n", priority=5)
    client.succeed(high)
    assert client.job(low)["state"] in ("QUEUED", "PREPARING", "RUNNING")
    client.succeed(low)


def test_same_key_and_body_give_the_same_job(client: Client) -> None:
    body = client.job_body("fake: spp 1\n", name="a")
    headers = {"Idempotency-Key": "a key"}
    first = client.http.post("/v1/jobs", json=body, headers=headers)
    again = client.http.post("/v1/jobs", json=body, headers=headers)
    other = client.http.post("/v1/jobs", json=body | {"name": "b"}, headers=headers)
    assert (first.status_code, again.status_code, other.status_code) == (201, 200, 409)
    assert first.headers["location"] == again.headers["location"] == f"/v1/jobs/{first.json()['id']}"
    assert other.json()["type"] == "urn:fluxfarm:problem:idempotency-conflict"
    assert len(client.http.get("/v1/jobs").json()["jobs"]) == 1


def test_prefer_wait_returns_when_the_job_ends_or_the_time_is_up(client: Client) -> None:
    slow = client.submit(SLOW)
    started = time.monotonic()
    reply = client.http.get(f"/v1/jobs/{slow}", headers={"Prefer": "wait=1"})
    assert reply.headers["preference-applied"] == "wait=1"
    assert 0.9 < time.monotonic() - started < 3
    client.http.post(f"/v1/jobs/{slow}:cancel")
    quick = client.submit("fake: spp 1\n")
    reply = client.http.get(f"/v1/jobs/{quick}", headers={"Prefer": "respond-async, wait=20"})
    assert reply.json()["state"] == "SUCCEEDED"


def test_time_goal_stops_near_its_time(client: Client) -> None:
    job_id = client.submit("fake: size 32 32\nfake: tile_seconds 0.02\n", goal={"seconds": 1.0})
    client.succeed(job_id)
    report = client.http.get(f"/v1/jobs/{job_id}/report").json()
    assert report["timeline"][-1]["seconds"] < 3
    assert report["timeline"][-1]["spp"] >= 2


def test_error_goal_stops_at_the_pass_that_meets_it(client: Client) -> None:
    job = client.succeed(client.submit("fake: size 32 32\n", goal={"rel_error": 0.2}))
    assert job["progress"]["error_now"] == pytest.approx(32**-0.5)
    assert job["progress"]["samples_done"] == 32 * 32 * 32
    assert job["warnings"] == []


def test_error_goal_that_misses_light_ends_with_the_engines_warning(client: Client) -> None:
    job_id = client.submit("fake: size 32 32\nfake: unseen 0.5 light is missing\n", goal={"rel_error": 0.3})
    job = client.succeed(job_id)
    assert job["warnings"] == ["light is missing"]
    assert job["progress"]["samples_done"] == 32 * 32 * 16, "the first round decides"
    assert client.http.get(f"/v1/jobs/{job_id}/report").json()["error"]["unseen"] == 0.5


def test_limit_before_the_goal_is_a_warning(client: Client) -> None:
    job = client.succeed(client.submit("fake: size 32 32\n", goal={"rel_error": 0.001}, limits={"spp": 20}))
    assert job["progress"]["samples_done"] == 32 * 32 * 20
    assert "goal not reached" in job["warnings"][0]


def test_size_crop_seed_and_integrator_reach_the_engine(client: Client) -> None:
    crop = {"x": 8, "y": 4, "width": 40, "height": 20}
    job_id = client.submit(
        "fake: spp 2\n", size={"width": 100, "height": 50}, crop=crop, seed=5, integrator="path", name="a name"
    )
    job = client.succeed(job_id)
    assert (job["size"], job["crop"]) == ({"width": 100, "height": 50}, crop)
    assert (job["seed"], job["integrator"], job["name"]) == (5, "path", "a name")
    assert job["progress"]["samples_done"] == 40 * 20 * 2


def test_another_seed_gives_another_image(client: Client) -> None:
    assert client.render("fake: spp 2\n", seed=1) != client.render("fake: spp 2\n", seed=2)
