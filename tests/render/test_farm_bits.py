"""A farm of workers with the real engine makes the same bits as one process, by every method."""

from collections.abc import Iterator
from pathlib import Path

import pytest
from conftest import ENGINE, ROOT, read_exr, render_alone, same_bits
from farm_nodes import Nodes

SIDE = 64
SPP = 20
SCENE = ROOT / "scenes" / "cornell-glass" / "scene.xml"


@pytest.fixture(scope="module")
def nodes(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Nodes]:
    """A service and three workers."""
    farm = Nodes(tmp_path_factory.mktemp("farm"), ENGINE, tile_size=16)
    try:
        for _ in range(3):
            farm.add_worker()
        farm.serve()
        farm.wait_for_ready(3)
        yield farm
    finally:
        farm.close()


@pytest.mark.parametrize("method", ["path", "photon", "photon-progressive", "irradiance-cache"])
def test_three_workers_make_the_bits_of_one_process(nodes: Nodes, method: str, tmp_path: Path) -> None:
    client = nodes.client
    assert client is not None
    options = ("--size", f"{SIDE}x{SIDE}", "--spp", SPP, "--seed", 5, "--integrator", method, "--threads", 2)
    alone = render_alone(SCENE, tmp_path / "alone.exr", *options)
    size = {"width": SIDE, "height": SIDE}
    job_id = client.submit(SCENE.read_text(), size=size, goal={"spp": SPP}, seed=5, integrator=method)
    client.succeed(job_id)
    image = tmp_path / "farm.exr"
    image.write_bytes(client.http.get(f"/v1/jobs/{job_id}/image.exr").content)
    assert same_bits(alone, read_exr(image))


def test_error_goal_ends_at_the_same_round(nodes: Nodes, tmp_path: Path) -> None:
    client = nodes.client
    assert client is not None
    options = ("--size", f"{SIDE}x{SIDE}", "--rel-error", 0.2, "--seed", 5, "--integrator", "auto", "--threads", 2)
    alone = render_alone(SCENE, tmp_path / "alone.exr", *options)
    size = {"width": SIDE, "height": SIDE}
    job_id = client.submit(SCENE.read_text(), size=size, goal={"rel_error": 0.2}, seed=5, integrator="auto")
    client.succeed(job_id)
    image = tmp_path / "farm.exr"
    image.write_bytes(client.http.get(f"/v1/jobs/{job_id}/image.exr").content)
    assert same_bits(alone, read_exr(image))
