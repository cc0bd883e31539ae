"""Workers on three hosts of their own, network namespaces on a bridge: one is cut off for a while and comes back."""

import os
import shutil
import subprocess
import time
from collections.abc import Callable, Iterator
from contextlib import suppress
from pathlib import Path

import pytest
from farm_client import Client
from farm_nodes import Nodes

SCENE = "fake: size 64 64\nfake: spp 16\nfake: tile_seconds 0.3\n"
TILES, PASSES = 16, 5
NETWORK = "10.213.77"
BRIDGE = "fluxfarm-br"
HOSTS = (1, 2, 3)

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(os.getuid() != 0 or shutil.which("ip") is None, reason="needs root and iproute2 to make hosts"),
]


def ip(*words: object) -> None:
    subprocess.run(["ip", *map(str, words)], check=True, capture_output=True)


def link(host: int) -> str:
    return f"fluxfarm-v{host}"


def remove_hosts() -> None:
    for host in HOSTS:
        with suppress(subprocess.CalledProcessError):
            ip("netns", "delete", f"fluxfarm-{host}")
    with suppress(subprocess.CalledProcessError):
        ip("link", "delete", BRIDGE)


@pytest.fixture
def hosts() -> Iterator[None]:
    """A bridge, and behind it a network namespace for each host."""
    remove_hosts()
    try:
        ip("link", "add", BRIDGE, "type", "bridge")
        ip("address", "add", f"{NETWORK}.254/24", "dev", BRIDGE)
        ip("link", "set", BRIDGE, "up")
        for host in HOSTS:
            name = f"fluxfarm-{host}"
            ip("netns", "add", name)
            ip("link", "add", link(host), "type", "veth", "peer", "name", "eth0", "netns", name)
            ip("link", "set", link(host), "master", BRIDGE, "up")
            ip("-n", name, "address", "add", f"{NETWORK}.{host}/24", "dev", "eth0")
            ip("-n", name, "link", "set", "eth0", "up")
            ip("-n", name, "link", "set", "lo", "up")
    except subprocess.CalledProcessError as error:
        remove_hosts()
        pytest.skip(f"cannot make network namespaces here: {error.stderr.decode().strip()}")
    yield
    remove_hosts()


def test_host_that_is_cut_off_for_a_while_changes_nothing(
    hosts: None, start: Callable[..., Client], tmp_path: Path, engine: Path
) -> None:
    undisturbed = start(data=tmp_path / "calm").render(SCENE, seed=3)
    nodes = Nodes(tmp_path, engine, host=f"{NETWORK}.254", tile_size=16)
    try:
        for host in HOSTS:
            nodes.add_worker(inside=("ip", "netns", "exec", f"fluxfarm-{host}"))
        client = nodes.serve()
        nodes.wait_for_ready(3)
        job_id = client.submit(SCENE, seed=3)
        client.wait_until(job_id, lambda job: job["progress"]["tiles_done"] >= 10)
        ip("link", "set", link(1), "down")
        time.sleep(20)
        ip("link", "set", link(1), "up")
        client.succeed(job_id)
        assert client.image_digest(job_id) == undisturbed
        tiles = [event for event in client.events(job_id) if event["event"] == "tile"]
        assert len(tiles) == len({(e["data"]["pass"], e["data"]["x"], e["data"]["y"]) for e in tiles}) == TILES * PASSES
        nodes.wait_for_ready(3)
        assert client.render(SCENE, seed=3) == undisturbed
    finally:
        nodes.close()
