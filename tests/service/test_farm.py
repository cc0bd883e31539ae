"""A service and workers as processes of their own, over TLS, with the fake engine: what goes wrong between them."""

import asyncio
import hashlib
import os
import signal
import subprocess
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from farm_client import Client
from farm_nodes import COMMAND, Nodes

from fluxfarm.adapters.dask.worker_side import WorkerHost
from fluxfarm.adapters.engine.process import EngineCommand
from fluxfarm.domain.leases import FailureKind, RenderLease, SceneRef
from fluxfarm.domain.scene import SceneBundle
from fluxfarm.domain.schedule import SampleRange
from fluxfarm.domain.tiles import PixelRect
from fluxfarm.settings import Settings

SCENE = "fake: size 64 64\nfake: spp 16\nfake: tile_seconds 0.05\n"
TILES, PASSES = 16, 5


@pytest.fixture
def nodes(tmp_path: Path, engine: Path) -> Iterator[Nodes]:
    """A farm with a scheduler, three workers and a service."""
    farm = Nodes(tmp_path, engine, tile_size=16)
    try:
        for _ in range(3):
            farm.add_worker()
        farm.serve()
        farm.wait_for_ready(3)
        yield farm
    finally:
        farm.close()


@pytest.fixture
def undisturbed(start: Callable[..., Client], tmp_path: Path) -> str:
    """Digest of the image that one machine makes."""
    return start(data=tmp_path / "calm").render(SCENE, seed=3)


def finish(client: Client, job_id: str, digest: str) -> None:
    """The job ends with the same bits, and every tile was committed once."""
    client.succeed(job_id)
    assert client.image_digest(job_id) == digest
    tiles = [event for event in client.events(job_id) if event["event"] == "tile"]
    places = {(event["data"]["pass"], event["data"]["x"], event["data"]["y"]) for event in tiles}
    assert len(tiles) == len(places) == TILES * PASSES


def submit(client: Client, tiles: int) -> str:
    """A job, and wait until so many tiles are done."""
    job_id = client.submit(SCENE, seed=3)
    client.wait_until(job_id, lambda job: job["progress"]["tiles_done"] >= tiles)
    return job_id


def test_farm_makes_the_same_bits_as_one_machine(nodes: Nodes, undisturbed: str) -> None:
    client = nodes.client
    assert client is not None
    job_id = submit(client, 0)
    working = nodes.wait_for(lambda workers: sum(bool(worker["jobs"]) for worker in workers) == 3)
    assert {worker["threads"] for worker in working} == {1}
    finish(client, job_id, undisturbed)


def test_worker_that_is_killed_costs_nothing_but_time(nodes: Nodes, undisturbed: str) -> None:
    client = nodes.client
    assert client is not None
    job_id = submit(client, 10)
    nodes.workers[0].kill()
    nodes.wait_for_ready(2)
    nodes.add_worker()
    nodes.wait_for_ready(3)
    finish(client, job_id, undisturbed)


def test_scheduler_that_is_killed_and_started_again_loses_nothing(nodes: Nodes, undisturbed: str) -> None:
    client = nodes.client
    assert client is not None
    job_id = submit(client, 10)
    nodes.scheduler.kill()
    nodes.wait_for(lambda workers: all(worker["state"] == "UNKNOWN" for worker in workers))
    assert client.job(job_id)["state"] == "RUNNING"
    nodes.restart_scheduler()
    nodes.wait_for_ready(3)
    finish(client, job_id, undisturbed)


def test_service_that_is_killed_and_started_again_goes_on_with_its_workers(nodes: Nodes, undisturbed: str) -> None:
    client = nodes.client
    assert client is not None
    job_id = submit(client, 10)
    nodes.kill_service()
    client = nodes.serve()
    finish(client, job_id, undisturbed)


@pytest.mark.slow
def test_worker_that_stands_still_for_a_while_changes_nothing(nodes: Nodes, undisturbed: str) -> None:
    client = nodes.client
    assert client is not None
    job_id = submit(client, 10)
    nodes.workers[0].send_signal(signal.SIGSTOP)
    stopped = time.monotonic()
    finish(client, job_id, undisturbed)
    time.sleep(max(0.0, 30 - (time.monotonic() - stopped)))
    nodes.workers[0].send_signal(signal.SIGCONT)
    nodes.wait_for_ready(3)
    finish(client, job_id, undisturbed)
    assert client.render(SCENE, seed=3) == undisturbed


def test_cancel_reaches_leases_that_workers_hold(nodes: Nodes) -> None:
    client = nodes.client
    assert client is not None
    job_id = client.submit("fake: size 64 64\nfake: spp 16\nfake: tile_seconds 60\n")
    nodes.wait_for(lambda workers: all(worker["jobs"] for worker in workers))
    begun = time.monotonic()
    assert client.http.post(f"/v1/jobs/{job_id}:cancel").status_code == 200
    nodes.wait_for(lambda workers: all(worker["state"] == "READY" for worker in workers))
    assert time.monotonic() - begun < 2
    assert all(worker["restarts"] == 0 for worker in nodes.wait_for(lambda workers: True))


def test_worker_with_another_engine_is_refused_by_name(tmp_path: Path, engine: Path) -> None:
    other = tmp_path / "other-engine"
    other.write_text(engine.read_text().replace('"$@"', '"$@" --build fake-2'))
    other.chmod(0o755)
    farm = Nodes(tmp_path, engine, tile_size=16)
    try:
        farm.add_worker(engine=other)
        client = farm.serve()
        (refused,) = farm.wait_for(lambda workers: any(worker["state"] == "REFUSED" for worker in workers))
        assert "engine build fake-2" in refused["last_words"]
        assert "expected" in refused["last_words"]
        job_id = client.submit(SCENE)
        farm.add_worker()
        client.succeed(job_id)
    finally:
        farm.close()


def test_certificates_are_never_made_beside_a_part_of_others(tmp_path: Path) -> None:
    def make() -> "subprocess.CompletedProcess[str]":
        words = [*COMMAND, "certificates", str(tmp_path / "certs")]
        return subprocess.run(words, capture_output=True, text=True, check=False)

    assert make().returncode == 0
    kept = {path.name: path.read_bytes() for path in (tmp_path / "certs").iterdir()}
    assert all((tmp_path / "certs" / name).stat().st_mode & 0o777 == 0o600 for name in kept)
    assert "has certificates already" in make().stdout
    (tmp_path / "certs" / "node.pem").unlink()
    refused = make()
    assert refused.returncode == 3
    assert "has ca.pem, ca.key, node.key and not the rest" in refused.stderr
    assert (tmp_path / "certs" / "ca.pem").read_bytes() == kept["ca.pem"]


def test_worker_with_certificates_of_another_farm_does_not_join(nodes: Nodes, tmp_path: Path) -> None:
    foreign = tmp_path / "foreign"
    subprocess.run([*COMMAND, "certificates", str(foreign)], check=True, stdout=subprocess.DEVNULL)
    environment = nodes.environment | {"FLUXFARM_CERTIFICATES": str(foreign)}
    words = [*COMMAND, "worker", "--data", str(tmp_path / "stranger")]
    with subprocess.Popen(
        words, env=environment, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    ) as stranger:
        time.sleep(6)
        assert len(nodes.wait_for(lambda workers: True)) == 3
        stranger.terminate()
        out, _ = stranger.communicate(timeout=20)
    assert "joined" not in out


@pytest.mark.parametrize(
    ("address", "words"),
    [
        ("tcp://192.0.2.7:8786", "expected tls://"),
        ("tls://192.0.2.7:8786", "needs FLUXFARM_CERTIFICATES"),
        ("192.0.2.7", "expected tls://HOST:PORT"),
        ("", "expected tls://HOST:PORT"),
    ],
)
def test_farm_without_certificates_is_refused_beyond_this_machine(address: str, words: str, tmp_path: Path) -> None:
    environment = os.environ | {"FLUXFARM_DATA": str(tmp_path)}
    for command in (["serve", "--backend", "dask", "--port", "0"], ["worker"], ["scheduler"]):
        ran = subprocess.run(
            [*COMMAND, *command, "--scheduler", address],
            env=environment,
            capture_output=True,
            text=True,
            check=False,
            timeout=30,
        )
        assert ran.returncode == 3, ran.stderr
        assert words in ran.stderr


def test_lease_that_comes_after_its_cancel_does_not_begin(settings: Settings) -> None:
    scene = b"fake: size 16 16\nfake: tile_seconds 60\n"
    sha256 = hashlib.sha256(scene).hexdigest()
    bundle = SceneBundle("scene.xml", {"scene.xml": sha256})
    ref = SceneRef("key", Path("elsewhere"), "scene.xml", 0, 0, "", bundle)
    rect = PixelRect(0, 0, 16, 16)
    lease = RenderLease(7, "job", ref, 0, 0, SampleRange(0, 1), (0,), (rect,), Path("elsewhere"))
    command = EngineCommand(Path(settings.engine), 1, 30, settings.data, 0, False)

    async def scenario() -> None:
        host = WorkerHost(command, 1 << 20)
        await host.start()
        try:
            assert (await host.render(lease, bundle)).missing == (sha256,)
            await host.put(sha256, scene)
            host.cancel("another job", [7])
            host.cancel("job", [7])
            rendered = await asyncio.wait_for(host.render(lease, bundle), 20)
            assert rendered.failure == (FailureKind.CANCELLED, "cancelled before it began")
        finally:
            await host.close()

    asyncio.run(scenario())
