"""The service's side of proto/fluxfarm/v1: frames out, outcomes in."""

import contextlib
from dataclasses import replace
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fluxfarm.adapters.engine import codec
from fluxfarm.adapters.protocol import engine_pb2 as pb
from fluxfarm.domain.leases import (
    Decision,
    FailureKind,
    ImageInfo,
    LeaseFailed,
    MergeLease,
    RenderLease,
    SceneRef,
    TileRendered,
)
from fluxfarm.domain.scene import SceneBundle
from fluxfarm.domain.schedule import SampleRange
from fluxfarm.domain.tiles import PixelRect

SCENE = SceneRef("key", Path("/scene"), "scene.xml", 0, 0, "", SceneBundle("scene.xml", {"scene.xml": "0" * 64}))
RECTS = (PixelRect(0, 0, 16, 16), PixelRect(16, 0, 8, 16))
LEASE = RenderLease(7, "job", SCENE, 2**53 - 1, 3, SampleRange(4, 8), (0, 1), RECTS, Path("/scratch/7"))


def test_lease_becomes_one_frame_with_its_length_in_front() -> None:
    frame = codec.lease(5, LEASE)
    (length,) = codec.LENGTH.unpack(frame[:4])
    assert length == len(frame) - 4
    request = pb.Request.FromString(frame[4:])
    work = request.render_tiles
    assert (request.request_id, work.seed, work.samples.begin, work.samples.end) == (5, 2**53 - 1, 4, 8)
    assert f"{work.tiles_out}-1.tile" == str(LEASE.file(1))
    assert [(tile.x, tile.y, tile.width, tile.height) for tile in work.tiles] == [(0, 0, 16, 16), (16, 0, 8, 16)]


def test_decision_names_its_scene() -> None:
    info, crop = ImageInfo("job", "digest", "path", 1), PixelRect(0, 0, 16, 16)
    files = (Path("/tiles/t"),), None, Path("/scratch/8.exr"), Path("/scratch/8.png")
    merge = MergeLease(8, "job", 16, 16, crop, None, *files, info, 1, Decision(0.1, 2, 64, SCENE))
    work = pb.Request.FromString(codec.lease(5, merge)[4:]).merge_pass
    goal = work.error_goal
    assert (goal.rel_error, goal.round, goal.most_samples, goal.scene_key) == (0.1, 2, 64, "key")
    without = pb.Request.FromString(codec.lease(5, replace(merge, decision=None))[4:]).merge_pass
    assert not without.HasField("error_goal")


def test_tile_done_becomes_an_outcome_that_is_not_the_last() -> None:
    reply = pb.Reply(request_id=5, tile_done=pb.TileDone(tile=1, bytes=1000, seconds=0.5, rays=9))
    outcome, last = codec.outcome(LEASE, codec.decode(reply.SerializeToString()))
    assert outcome == TileRendered(LEASE, 1, 1000, 0.5, 9, 0)
    assert not last


@pytest.mark.parametrize("kind", FailureKind)
def test_failure_keeps_its_kind(kind: FailureKind) -> None:
    number = pb.FailureKind.Value(f"FAILURE_KIND_{kind}")
    reply = pb.Reply(request_id=5, failure=pb.Failure(kind=number, message="why"))
    assert codec.outcome(LEASE, codec.decode(reply.SerializeToString())) == (LeaseFailed(LEASE, kind, "why"), True)


def test_reply_that_does_not_fit_its_request_breaks_the_protocol() -> None:
    for body in ({"pass_merged": pb.PassMerged()}, {"tile_done": pb.TileDone(tile=2)}, {"pong": pb.Pong()}):
        with pytest.raises(codec.ProtocolError):
            codec.outcome(LEASE, codec.decode(pb.Reply(request_id=5, **body).SerializeToString()))


def test_hello_of_another_version_is_refused() -> None:
    reply = pb.Reply(hello=pb.Hello(protocol_version=codec.PROTOCOL_VERSION + 1))
    with pytest.raises(codec.ProtocolError, match="protocol_version"):
        codec.hello(codec.decode(reply.SerializeToString()))


@given(st.binary(max_size=200))
def test_any_bytes_are_a_reply_or_a_protocol_error(frame: bytes) -> None:
    with contextlib.suppress(codec.ProtocolError):
        codec.outcome(LEASE, codec.decode(frame))
