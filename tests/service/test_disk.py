"""A disk that is nearly full: jobs wait with the reason, uploads are refused, and all goes on when there is room."""

import shutil
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

import pytest
from farm_client import Client

from fluxfarm.cli.embedded import EmbeddedService
from fluxfarm.settings import Settings

SCENE = "fake: size 64 64\nfake: tile_seconds 0.03\n"
LEAST = 1000


class Usage(NamedTuple):
    total: int
    used: int
    free: int


@pytest.fixture
def free(monkeypatch: pytest.MonkeyPatch) -> Callable[[int], None]:
    """Says how many bytes of the disk are free; the service runs in this process."""
    usage = [Usage(1 << 30, 0, 1 << 30)]
    monkeypatch.setattr(shutil, "disk_usage", lambda path: usage[0])

    def now(bytes_free: int) -> None:
        usage[0] = Usage(1 << 30, (1 << 30) - bytes_free, bytes_free)

    return now


def test_job_waits_for_room_and_goes_on_by_itself(
    start: Callable[..., Client], free: Callable[[int], None], tmp_path: Path
) -> None:
    digest = start(data=tmp_path / "undisturbed").render(SCENE, goal={"spp": 16})
    client = start(least_free_bytes=LEAST)
    job_id = client.submit(SCENE, goal={"spp": 16})
    client.wait_until(job_id, lambda job: job["progress"]["tiles_done"] >= 2)
    free(LEAST - 1)
    waiting = client.wait_until(job_id, lambda job: job["state"] == "PAUSED")
    assert waiting["reason"].startswith("the disk is nearly full: 999 bytes free")
    assert "expected at least 1000" in waiting["reason"]
    refused = client.http.put(f"/v1/assets/{'0' * 64}", content=b"x")
    assert refused.status_code == 507
    assert "999 bytes free" in refused.json()["detail"]
    free(2 * LEAST - 1)  # not enough to go on
    client.succeed(client.submit(SCENE, goal={"spp": 1}))
    assert client.job(job_id)["state"] == "PAUSED"
    free(2 * LEAST)
    client.wait_until(job_id, lambda job: job["state"] != "PAUSED")
    assert client.succeed(job_id)["reason"] is None
    assert client.image_digest(job_id) == digest


def test_only_jobs_that_wait_for_room_go_on_after_a_restart(settings: Settings, free: Callable[[int], None]) -> None:
    settings = replace(settings, least_free_bytes=LEAST)

    def with_service(act: Callable[[Client], None]) -> None:
        with EmbeddedService(settings) as service:
            client = Client(service.url)
            try:
                act(client)
            finally:
                client.http.close()

    jobs: list[str] = []

    def fill_the_disk(client: Client) -> None:
        jobs.extend(client.submit(SCENE, goal={"spp": 16}, seed=seed) for seed in (0, 1))
        assert client.http.post(f"/v1/jobs/{jobs[0]}:pause").status_code == 200
        free(0)
        client.wait_until(jobs[1], lambda job: job["state"] == "PAUSED")

    def make_room(client: Client) -> None:
        free(2 * LEAST)
        client.succeed(jobs[1])
        assert client.job(jobs[0])["state"] == "PAUSED"
        assert client.job(jobs[0])["reason"] is None

    with_service(fill_the_disk)
    with_service(make_room)
