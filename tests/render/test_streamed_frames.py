"""Frames as they come: complete EXRs whose samples rise, also when the service is the real one with the real engine."""

import re
from pathlib import Path

import numpy as np
from conftest import read_exr
from farm import SIDE, Farm

# Some seconds of work: after each merge the next one waits sixteen times as long as it took.
SAMPLES = 600


def multipart_bodies(reply_type: str, body: bytes) -> list[bytes]:
    """The bodies of a multipart reply, each cut by its own Content-Length."""
    boundary = re.search(r'boundary="?([^";]+)', reply_type)
    assert boundary is not None
    bodies, rest = [], body
    while (start := rest.find(b"--" + boundary[1].encode())) >= 0 and not rest[start:].startswith(
        b"--" + boundary[1].encode() + b"--"
    ):
        head, rest = rest[start:].split(b"\r\n\r\n", 1)
        length = re.search(rb"content-length: *(\d+)", head.lower())
        assert length is not None, head
        bodies.append(rest[: int(length[1])])
        rest = rest[int(length[1]) :]
    return bodies


def test_frames_are_whole_images_whose_samples_rise(farms: list[Farm], tmp_path: Path) -> None:
    farms.append(farm := Farm(tmp_path, workers=2))
    job_id = farm.submit(goal={"spp": SAMPLES})
    reply = farm.client.http.get(f"/v1/jobs/{job_id}/frames", timeout=120)
    assert reply.headers["content-type"].startswith("multipart/mixed")
    samples = []
    for number, body in enumerate(multipart_bodies(reply.headers["content-type"], reply.content)):
        frame = tmp_path / f"{number}.exr"
        frame.write_bytes(body)
        layers = read_exr(frame)
        assert layers["R"].shape == (SIDE, SIDE)
        assert np.all(np.isfinite(layers["R"]))
        assert layers["samples"].min() == layers["samples"].max(), "a frame between two passes"
        samples.append(int(layers["samples"].max()))
    assert len(samples) >= 3
    assert samples == sorted(set(samples))
    assert samples[-1] == SAMPLES
