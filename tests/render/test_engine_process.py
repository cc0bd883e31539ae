"""The engine process behind its socket, without a service: loads that are cancelled, and who else waits for them."""

import socket
import struct
import subprocess
from collections.abc import Iterator
from typing import Any

import pytest
from conftest import ENGINE, ROOT

from fluxfarm.adapters.protocol import engine_pb2 as pb

CORNELL = ROOT / "scenes" / "cornell"
# A pilot of seconds on one thread.
LONG = {"width": 1024, "height": 1024, "integrator": "auto", "picture": pb.Picture(rel_error=0.01)}


class Engine:
    """One process with one thread."""

    def __init__(self) -> None:
        self.socket, theirs = socket.socketpair()
        with theirs:
            command = [str(ENGINE), "worker", "--fd", str(theirs.fileno()), "--threads", "1"]
            self.process = subprocess.Popen(command, pass_fds=[theirs.fileno()])
        self.stream = self.socket.makefile("rb")
        assert self.receive().WhichOneof("body") == "hello"

    def send(self, request_id: int, **body: Any) -> None:
        frame = pb.Request(request_id=request_id, **body).SerializeToString()
        self.socket.sendall(struct.pack("<I", len(frame)) + frame)

    def load(self, request_id: int, key: str, **options: Any) -> None:
        self.send(request_id, load_scene=pb.LoadScene(scene_key=key, folder=str(CORNELL), entry="scene.xml", **options))

    def receive(self) -> pb.Reply:
        (length,) = struct.unpack("<I", self.stream.read(4))
        return pb.Reply.FromString(self.stream.read(length))

    def replies(self, *request_ids: int) -> dict[int, pb.Reply]:
        """The last words about these requests."""
        found: dict[int, pb.Reply] = {}
        while not found.keys() >= set(request_ids):
            reply = self.receive()
            if reply.WhichOneof("body") not in ("progress", "tile_done"):
                found[reply.request_id] = reply
        return found


@pytest.fixture
def engine() -> Iterator[Engine]:
    started = Engine()
    yield started
    started.stream.close()
    started.socket.close()
    assert started.process.wait(timeout=20) == 0


def test_pilot_is_cancelled_and_its_scene_can_be_loaded_again(engine: Engine) -> None:
    engine.load(1, "long", **LONG)
    engine.send(2, cancel=pb.Cancel(target_request_id=1))
    assert engine.replies(1)[1].failure.kind == pb.FAILURE_KIND_CANCELLED
    engine.load(3, "long", **(LONG | {"width": 32, "height": 32}))
    assert engine.replies(3)[3].scene_loaded.integrator == "irradiance-cache"


def test_load_that_is_cancelled_before_it_begins_leaves_nothing_behind(engine: Engine) -> None:
    engine.load(1, "long", **LONG)  # the only thread is busy
    engine.load(2, "short", width=16, height=16)
    engine.send(3, cancel=pb.Cancel(target_request_id=2))
    engine.send(4, cancel=pb.Cancel(target_request_id=1))
    replies = engine.replies(1, 2)
    assert [replies[i].failure.kind for i in (1, 2)] == [pb.FAILURE_KIND_CANCELLED] * 2
    engine.load(5, "short", width=16, height=16)
    assert engine.replies(5)[5].scene_loaded.width == 16


def test_tiles_that_wait_for_a_cancelled_load_say_so(engine: Engine) -> None:
    engine.load(1, "long", **LONG)
    tile = pb.PixelRect(width=16, height=16)
    engine.send(2, render_tiles=pb.RenderTiles(scene_key="long", samples=pb.SampleRange(end=1), tiles=[tile]))
    engine.send(3, cancel=pb.Cancel(target_request_id=1))
    assert engine.replies(1, 2)[2].failure.kind == pb.FAILURE_KIND_CANCELLED
