"""Leases to frames of proto/fluxfarm/v1 and frames to outcomes. The only file that imports the generated protocol."""

import json
import struct
from dataclasses import dataclass
from pathlib import Path

from fluxfarm.adapters.protocol import engine_pb2 as pb
from fluxfarm.domain.leases import (
    Decision,
    FailureKind,
    ImageInfo,
    Lease,
    LeaseFailed,
    Merged,
    MergeLease,
    Outcome,
    Picture,
    Prepared,
    PrepareLease,
    RenderLease,
    SamplesTaken,
    SceneRef,
    TileRendered,
    TilesFinished,
    TileWritten,
    WriteTileLease,
)
from fluxfarm.domain.records import SceneFacts
from fluxfarm.domain.schedule import Round, SampleRange
from fluxfarm.domain.tiles import PixelRect

PROTOCOL_VERSION = 6
MAX_FRAME_BYTES = 64 << 20
LENGTH = struct.Struct("<I")

_KINDS = {
    pb.FAILURE_KIND_SCENE: FailureKind.SCENE,
    pb.FAILURE_KIND_RESOURCE: FailureKind.RESOURCE,
    pb.FAILURE_KIND_CANCELLED: FailureKind.CANCELLED,
}


class ProtocolError(Exception):
    """The engine process said something that the protocol does not allow."""


@dataclass(frozen=True, slots=True)
class Hello:
    """The first words of an engine process."""

    protocol_version: int
    engine_build: str
    threads: int
    pid: int
    sandbox_missing: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Reply:
    """A decoded frame; `body` is still the generated message."""

    request_id: int
    body: object


def load_scene(request_id: int, scene: SceneRef) -> bytes:
    """The frame that makes a process read and keep a scene."""
    body = pb.LoadScene(
        scene_key=scene.key,
        folder=str(scene.folder),
        entry=scene.entry,
        width=scene.width,
        height=scene.height,
        integrator=scene.integrator,
        picture=None if scene.picture is None else _picture(scene.picture),
    )
    return _frame(pb.Request(request_id=request_id, load_scene=body))


def cancel(request_id: int, target: int) -> bytes:
    """The frame that ends the request `target`."""
    return _frame(pb.Request(request_id=request_id, cancel=pb.Cancel(target_request_id=target)))


def lease(request_id: int, work: Lease) -> bytes:
    """The frame that carries out a lease; a scene it needs must have been loaded before."""
    if isinstance(work, PrepareLease):
        return load_scene(request_id, work.scene)
    if isinstance(work, RenderLease):
        return _frame(pb.Request(request_id=request_id, render_tiles=_render_tiles(work)))
    if isinstance(work, MergeLease):
        return _frame(pb.Request(request_id=request_id, merge_pass=_merge_pass(work)))
    if isinstance(work, WriteTileLease):
        return _frame(pb.Request(request_id=request_id, write_tile=_write_tile(work)))
    raise TypeError(f"no request for {type(work).__name__}")


def decode(frame: bytes) -> Reply:
    """One frame without its length; raises ProtocolError."""
    reply = pb.Reply()
    try:
        reply.ParseFromString(frame)
    except Exception as error:
        raise ProtocolError(f"a frame of {len(frame)} bytes is not a Reply: {error}") from None
    kind = reply.WhichOneof("body")
    if kind is None:
        raise ProtocolError(f"the reply to request {reply.request_id} has no body that this service knows")
    return Reply(reply.request_id, getattr(reply, kind))


def hello(reply: Reply) -> Hello:
    """The Hello in `reply`; raises ProtocolError if it is something else or of another version."""
    body = reply.body
    if not isinstance(body, pb.Hello):
        raise ProtocolError(f"the first message is {type(body).__name__}, expected Hello")
    if body.protocol_version != PROTOCOL_VERSION:
        raise ProtocolError(f"protocol_version = {body.protocol_version}, expected {PROTOCOL_VERSION}: build both anew")
    return Hello(body.protocol_version, body.engine_build, body.threads, body.pid, tuple(body.sandbox_missing))


def outcome(work: Lease, reply: Reply) -> tuple[Outcome, bool]:
    """What `reply` says about `work`, and whether it is the last word; raises ProtocolError if it does not fit."""
    body = reply.body
    if isinstance(body, pb.Failure):
        return LeaseFailed(work, _KINDS.get(body.kind, FailureKind.INTERNAL), body.message), True
    if isinstance(work, RenderLease):
        if isinstance(body, pb.TileDone) and body.tile < len(work.tiles):
            done = TileRendered(work, body.tile, body.bytes, body.seconds, body.rays, body.non_finite_samples)
            return done, False
        if isinstance(body, pb.Progress):
            return SamplesTaken(work, body.samples), False
        if isinstance(body, pb.TilesDone):
            return TilesFinished(work), True
    if isinstance(work, PrepareLease) and isinstance(body, pb.SceneLoaded):
        return Prepared(work, _facts(body)), True
    if isinstance(work, MergeLease) and isinstance(body, pb.PassMerged):
        return _merged(work, body), True
    if isinstance(work, WriteTileLease) and isinstance(body, pb.TileWritten):
        return TileWritten(work), True
    raise ProtocolError(f"{type(body).__name__} does not answer a {type(work).__name__}")


def is_progress(reply: Reply) -> bool:
    """Whether the reply only says that work goes on."""
    return isinstance(reply.body, pb.Progress)


def is_scene_loaded(reply: Reply) -> bool:
    """Whether the reply says that a scene is kept now."""
    return isinstance(reply.body, pb.SceneLoaded)


def failure_of(reply: Reply, work: Lease) -> LeaseFailed | None:
    """The failure of a scene that `work` needed, or None if the reply is no failure."""
    if not isinstance(reply.body, pb.Failure):
        return None
    return LeaseFailed(work, _KINDS.get(reply.body.kind, FailureKind.INTERNAL), reply.body.message)


def _frame(request: pb.Request) -> bytes:
    body = request.SerializeToString()
    return LENGTH.pack(len(body)) + body


def _picture(picture: Picture) -> pb.Picture:
    goal, crop = picture.goal, picture.crop
    return pb.Picture(
        crop=None if crop is None else _rect(crop),
        seed=picture.seed,
        rel_error=goal.rel_error,
        spp=goal.spp,
        seconds=goal.seconds,
    )


def _render_tiles(work: RenderLease) -> pb.RenderTiles:
    return pb.RenderTiles(
        scene_key=work.scene.key,
        seed=work.seed,
        samples=pb.SampleRange(begin=work.samples.begin, end=work.samples.end),
        tiles=[_rect(rect) for rect in work.rects],
        tiles_out=str(work.tiles_out),
    )


def _merge_pass(work: MergeLease) -> pb.MergePass:
    return pb.MergePass(
        width=work.width,
        height=work.height,
        crop=_rect(work.crop),
        film_in=_path(work.film_in),
        tiles=[pb.TileFile(path=str(path)) for path in work.tiles],
        film_out=_path(work.film_out),
        exr_out=str(work.exr_out),
        png_out=str(work.png_out),
        info=_info(work.info),
        error_goal=None if work.decision is None else _error_goal(work.decision),
    )


def _error_goal(decision: Decision) -> pb.ErrorGoal:
    return pb.ErrorGoal(
        rel_error=decision.rel_error,
        round=decision.round,
        most_samples=decision.most_samples,
        scene_key=decision.scene.key,
    )


def _merged(work: MergeLease, body: pb.PassMerged) -> Merged:
    decided = work.decision is not None and body.HasField("error_bound")
    following = None
    if work.decision is not None and body.HasField("next_round"):
        samples = SampleRange(body.next_round.samples.begin, body.next_round.samples.end)
        following = Round(work.decision.round + 1, samples, tuple(body.next_round.tiles))
    return Merged(
        lease=work,
        min_samples=body.min_samples,
        max_samples=body.max_samples,
        mean_samples=body.mean_samples,
        error_noise=body.error_noise if body.HasField("error_noise") else None,
        error_bias=body.error_bias if body.HasField("error_bias") else None,
        mean=(body.mean_r, body.mean_g, body.mean_b),
        non_finite_samples=body.non_finite_samples,
        seconds=body.seconds,
        error_bound=body.error_bound if decided else None,
        next_round=following,
        samples_expected=body.samples_expected if decided else None,
        error_unseen=body.error_unseen if body.HasField("error_unseen") else None,
        unseen_warning=body.warning or None,
    )


def _write_tile(work: WriteTileLease) -> pb.WriteTile:
    return pb.WriteTile(
        width=work.width,
        height=work.height,
        rect=_rect(work.rect),
        film_in=_path(work.film_in),
        tiles=[pb.TileFile(path=str(path)) for path in work.tiles],
        exr_out=str(work.exr_out),
        info=_info(work.info),
    )


def _rect(rect: PixelRect) -> pb.PixelRect:
    return pb.PixelRect(x=rect.x, y=rect.y, width=rect.width, height=rect.height)


def _path(path: Path | None) -> str:
    return "" if path is None else str(path)


def _info(info: ImageInfo) -> pb.ImageInfo:
    return pb.ImageInfo(job=info.job_id, scene_digest=info.scene_digest, integrator=info.integrator, seed=info.seed)


def _facts(body: pb.SceneLoaded) -> SceneFacts:
    try:
        plan = json.loads(body.plan_json or "{}")
    except ValueError as error:
        raise ProtocolError(f"SceneLoaded.plan_json is not JSON: {error}") from None
    crop = PixelRect(body.crop.x, body.crop.y, body.crop.width, body.crop.height)
    if crop.area == 0:
        crop = PixelRect(0, 0, body.width, body.height)
    return SceneFacts(
        body.width, body.height, crop, body.scene_spp, body.integrator, tuple(body.warnings), plan, body.seconds
    )
