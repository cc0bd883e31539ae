"""Engine processes of a real service are shut in, render all the same, and take no more memory than their share."""

import struct
import subprocess
import zlib
from pathlib import Path

import pytest
from conftest import ENGINE
from farm import SCENE, Farm

SHARE = 200 << 20
PIXELS = 2000


def png() -> bytes:
    """A white picture of one pixel."""

    def chunk(name: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))

    head = chunk(b"IHDR", struct.pack(">IIBBBBB", 1, 1, 8, 2, 0, 0, 0))
    return b"\x89PNG\r\n\x1a\n" + head + chunk(b"IDAT", zlib.compress(b"\0\xff\xff\xff")) + chunk(b"IEND", b"")


# Its floor has an image, which a library reads that is loaded for it.
PAINTED = """<scene version="3.0.0"><sensor type="perspective"/><emitter type="constant"/>
<shape type="rectangle"><bsdf type="diffuse"><texture type="bitmap" name="reflectance">
<string name="filename" value="white.png"/></texture></bsdf></shape></scene>"""


def test_processes_are_wholly_shut_in_and_read_images(tmp_path: Path, farms: list[Farm]) -> None:
    farms.append(farm := Farm(tmp_path))
    files = {"scene.xml": farm.client.upload(PAINTED), "white.png": farm.client.upload(png())}
    body = {"scene": {"entry": "scene.xml", "files": files}, "size": {"width": 8, "height": 8}, "goal": {"spp": 4}}
    farm.client.succeed(farm.client.http.post("/v1/jobs", json=body).json()["id"])
    (worker,) = farm.client.http.get("/v1/workers").json()["workers"]
    assert worker["sandbox_missing"] == []
    status = Path(f"/proc/{worker['pid']}/status").read_text()
    assert "NoNewPrivs:\t1" in status
    assert "Seccomp:\t2" in status
    assert not any("shut in" in warning for warning in farm.client.http.get("/v1/system").json()["warnings"])


def test_scene_that_eats_memory_fails_alone(tmp_path: Path, farms: list[Farm], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("FLUXFARM_WORKER_MEMORY_BYTES", str(SHARE))
    farms.append(farm := Farm(tmp_path, tile_size=256))
    small = farm.submit(goal={"spp": 8})
    large = farm.client.submit(SCENE.read_text(), size={"width": PIXELS, "height": PIXELS}, goal={"spp": 1})
    job = farm.client.finish(large)
    assert job["state"] == "FAILED", job
    assert "memory" in job["reason"]
    farm.client.succeed(small)
    farm.client.succeed(farm.submit(goal={"spp": 8}))


def test_process_that_is_not_shut_in_is_refused_where_that_is_required() -> None:
    command = [ENGINE, "worker", "--fd", "0", "--require-sandbox"]
    done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=20)
    assert done.returncode == 1
    assert "the sandbox is not whole, without: not asked for" in done.stderr
