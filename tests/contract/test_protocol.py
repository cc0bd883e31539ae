"""The service's side of proto/fluxfarm/v1: frames out, outcomes in."""

import contextlib
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fluxfarm.adapters.engine import codec
from fluxfarm.adapters.protocol import engine_pb2 as pb
from fluxfarm.domain.leases import FailureKind, LeaseFailed, RenderLease, SceneRef, TileRendered
from fluxfarm.domain.schedule import SampleRange
from fluxfarm.domain.tiles import PixelRect

SCENE = SceneRef("key", Path("/scene"), "scene.xml", 0, 0, "")
RECTS = (PixelRect(0, 0, 16, 16), PixelRect(16, 0, 8, 16))
LEASE = RenderLease(7, "job", SCENE, 2**53 - 1, 3, SampleRange(4, 8), (0, 1), RECTS)


def test_lease_becomes_one_frame_with_its_length_in_front() -> None:
    frame = codec.lease(5, LEASE)
    (length,) = codec.LENGTH.unpack(frame[:4])
    assert length == len(frame) - 4
    request = pb.Request.FromString(frame[4:])
    work = request.render_tiles
    assert (request.request_id, work.seed, work.samples.begin, work.samples.end) == (5, 2**53 - 1, 4, 8)
    assert [(tile.x, tile.y, tile.width, tile.height) for tile in work.tiles] == [(0, 0, 16, 16), (16, 0, 8, 16)]


def test_tile_done_becomes_an_outcome_that_is_not_the_last() -> None:
    reply = pb.Reply(request_id=5, tile_done=pb.TileDone(tile=1, sums=b"sums", seconds=0.5, rays=9))
    outcome, last = codec.outcome(LEASE, codec.decode(reply.SerializeToString()))
    assert outcome == TileRendered(LEASE, 1, b"sums", 0.5, 9, 0)
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
