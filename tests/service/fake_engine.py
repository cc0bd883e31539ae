"""An engine without pictures: speaks proto/fluxfarm/v1 and does what its scene file tells it.

Lines `fake: VERB ARGUMENTS` anywhere in the scene file, for example inside XML comments:

    size W H           frame size, else 64 64            spp N            samples the scene asks for
    tile_seconds S     time of each tile, else 0         load_seconds S   time of LoadScene
    fail KIND TEXT     LoadScene answers Failure         warn TEXT        a warning of SceneLoaded
    crash_in_pass B    SIGKILL itself in the pass that begins at sample B
    crash_once FILE    the same in the second pass, but only if FILE is not there yet (it is made first)
    run_out FILE       RenderTiles answers RESOURCE twice, counting in FILE
    deaf               renders for ever and does not hear Cancel
    damage HOW N FILE  the first tile of RenderTiles, N times, counting in FILE: its file is `missing` or `cut`
    unseen E TEXT      decisions find the error E by missing light and end the job with the warning TEXT

The sums of a tile depend on (seed, rect, sample range) alone; a film is the digests of all tiles merged so far.
"""

import argparse
import contextlib
import hashlib
import json
import os
import queue
import re
import signal
import socket
import struct
import threading
import time
from pathlib import Path

from fluxfarm.adapters.protocol import engine_pb2 as pb

PROTOCOL_VERSION = 6
EXR_MAGIC = b"\x76\x2f\x31\x01"
PNG_MAGIC = b"\x89PNG\r\n\x1a\n"


class Cancelled(Exception):
    """The service does not want this request's result any more."""


class FakeEngine:
    def __init__(self, connection: socket.socket, threads: int, build: str) -> None:
        self.connection, self.threads, self.build = connection, threads, build
        self.requests: queue.SimpleQueue[pb.Request | None] = queue.SimpleQueue()
        self.cancelled: set[int] = set()
        self.scenes: dict[str, dict[str, str]] = {}

    def run(self) -> None:
        self.reply(
            0,
            hello=pb.Hello(
                protocol_version=PROTOCOL_VERSION, engine_build=self.build, threads=self.threads, pid=os.getpid()
            ),
        )
        threading.Thread(target=self.read_to_the_end, daemon=True).start()
        while (request := self.requests.get()) is not None:
            kind = request.WhichOneof("body")
            try:
                if request.request_id in self.cancelled:
                    raise Cancelled
                getattr(self, kind)(request.request_id, getattr(request, kind))
            except Cancelled:
                self.fail(request.request_id, pb.FAILURE_KIND_CANCELLED, "cancelled")

    def read_to_the_end(self) -> None:
        with contextlib.suppress(ConnectionError):  # a service that was killed leaves replies unread
            self.read_requests()
        os._exit(0)  # end of file ends the engine, whatever it does

    def read_requests(self) -> None:
        stream = self.connection.makefile("rb")
        while len(length := stream.read(4)) == 4:
            request = pb.Request.FromString(stream.read(struct.unpack("<I", length)[0]))
            if request.WhichOneof("body") == "cancel":
                self.cancelled.add(request.cancel.target_request_id)
            elif request.WhichOneof("body") == "ping":
                self.reply(request.request_id, pong=pb.Pong())
            else:
                self.requests.put(request)

    def reply(self, request_id: int, **body: object) -> None:
        frame = pb.Reply(request_id=request_id, **body).SerializeToString()
        self.connection.sendall(struct.pack("<I", len(frame)) + frame)

    def fail(self, request_id: int, kind: int, message: str) -> None:
        self.reply(request_id, failure=pb.Failure(kind=kind, message=message))

    def load_scene(self, request_id: int, load: pb.LoadScene) -> None:
        text = (Path(load.folder) / load.entry).read_text(errors="replace")
        told = dict(re.findall(r"fake: *(\w+) *(.*?) *(?:-->|$)", text, re.MULTILINE))
        if "fail" in told:
            kind, _, message = told["fail"].partition(" ")
            return self.fail(request_id, pb.FailureKind.Value("FAILURE_KIND_" + kind), message)
        if load.integrator == "auto" and not load.HasField("picture"):
            return self.fail(request_id, pb.FAILURE_KIND_INTERNAL, "auto without a picture")
        self.wait(request_id, float(told.get("load_seconds", 0)))
        self.scenes[load.scene_key] = told
        width, height = (int(side) for side in told.get("size", "64 64").split())
        width, height = load.width or width, load.height or height
        loaded = pb.SceneLoaded(
            width=width,
            height=height,
            scene_spp=int(told.get("spp", 0)),
            crop=pb.PixelRect(width=width, height=height),
            integrator="path" if load.integrator in ("", "auto") else load.integrator,
            warnings=[told["warn"]] if "warn" in told else [],
            plan_json='{"integrator": "path", "parts": {}}',
        )
        return self.reply(request_id, scene_loaded=loaded)

    def render_tiles(self, request_id: int, work: pb.RenderTiles) -> None:
        told = self.scenes[work.scene_key]
        if "run_out" in told and len(read(told["run_out"])) < 2:
            append(told["run_out"], b"x")
            return self.fail(request_id, pb.FAILURE_KIND_RESOURCE, "out of memory: 8 GiB, expected less")
        while "deaf" in told:
            time.sleep(1)
        for index, rect in enumerate(work.tiles):
            file = Path(f"{work.tiles_out}-{index}.tile")
            self.crash_if_told(told, work.samples, file)
            self.wait(request_id, float(told.get("tile_seconds", 0)))
            key = f"{work.seed} {rect.x},{rect.y},{rect.width},{rect.height} {work.samples.begin}-{work.samples.end}"
            sums = pb.TileSums(
                rect=rect, samples=work.samples, seed=work.seed, radiance=hashlib.sha256(key.encode()).digest()
            )
            count = work.samples.end - work.samples.begin
            seconds = float(told.get("tile_seconds", 0.0001))
            size = file.write_bytes(sums.SerializeToString())
            if index == 0 and "damage" in told:
                damage(file, *told["damage"].split())
            done = pb.TileDone(tile=index, bytes=size, seconds=seconds, rays=rect.width * rect.height * count)
            self.reply(request_id, tile_done=done)
        return self.reply(request_id, tiles_done=pb.TilesDone())

    def merge_pass(self, request_id: int, work: pb.MergePass) -> None:
        decides = work.HasField("error_goal")
        if decides and work.error_goal.scene_key not in self.scenes:
            return self.fail(request_id, pb.FAILURE_KIND_RESOURCE, "the scene to audit is not loaded, LoadScene first")
        film, samples = read(work.film_in), 0
        for file in work.tiles:
            tile = pb.TileSums.FromString(Path(file.path).read_bytes())
            samples = max(samples, tile.samples.end)
            film += hashlib.sha256(tile.SerializeToString()).digest()
        if work.film_out:
            Path(work.film_out).write_bytes(film)
        Path(work.exr_out).write_bytes(image(film, samples))
        Path(work.png_out).write_bytes(PNG_MAGIC + hashlib.sha256(film).digest())
        counts = {"min_samples": samples, "max_samples": samples, "mean_samples": samples}
        merged = pb.PassMerged(**counts, mean_r=0.5, mean_g=0.25, mean_b=0.125, error_bias=0)
        if samples >= 2:
            merged.error_noise = samples**-0.5
            if decides:
                decide(work, merged, self.scenes[work.error_goal.scene_key])
        return self.reply(request_id, pass_merged=merged)

    def write_tile(self, request_id: int, work: pb.WriteTile) -> None:
        Path(work.exr_out).write_bytes(image(read(work.film_in), len(work.tiles)))
        self.reply(request_id, tile_written=pb.TileWritten())

    def wait(self, request_id: int, seconds: float) -> None:
        end = time.monotonic() + seconds
        while (left := end - time.monotonic()) > 0:
            if request_id in self.cancelled:
                raise Cancelled
            time.sleep(min(left, 0.05))
        if request_id in self.cancelled:
            raise Cancelled

    def crash_if_told(self, told: dict[str, str], samples: pb.SampleRange, file: Path) -> None:
        once = told.get("crash_once")
        if once and samples.begin >= 1 and not Path(once).exists():
            append(once, b"crashed")
        elif int(told.get("crash_in_pass", -1)) != samples.begin:
            return
        print("about to crash, as told", flush=True)
        file.write_bytes(b"half of a tile")
        os.kill(os.getpid(), signal.SIGKILL)


def image(film: bytes, samples: int) -> bytes:
    """A file that starts like an EXR; its bytes tell its film and its samples apart from all others."""
    return EXR_MAGIC + struct.pack("<I", samples) + hashlib.sha256(film).digest() + bytes(1000)


def damage(file: Path, how: str, most: str, counted: str) -> None:
    if len(read(counted)) == int(most):
        return
    append(counted, b"x")
    if how == "cut":
        os.truncate(file, file.stat().st_size // 2)
    else:
        file.unlink()


def decide(work: pb.MergePass, merged: pb.PassMerged, told: dict[str, str]) -> None:
    """The bound is the estimate; while it is too large every tile goes on, unless light is missing."""
    goal, samples = work.error_goal, merged.max_samples
    merged.error_bound = merged.error_noise
    merged.samples_expected = work.crop.width * work.crop.height * goal.rel_error**-2
    unseen, _, warning = told.get("unseen", "0").partition(" ")
    merged.error_unseen, merged.warning = float(unseen), warning
    if warning:
        merged.error_bound = max(merged.error_bound, merged.error_unseen)
        return
    if merged.error_bound > goal.rel_error and samples < goal.most_samples:
        tiles = -(-work.crop.width // 32) * -(-work.crop.height // 32)
        merged.next_round.samples.begin, merged.next_round.samples.end = samples, min(2 * samples, goal.most_samples)
        merged.next_round.tiles.extend(range(tiles))


def read(path: str) -> bytes:
    return Path(path).read_bytes() if path and Path(path).exists() else b""


def append(path: str, text: bytes) -> None:
    with Path(path).open("ab") as file:
        file.write(text)


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("command", choices=["worker", "info"])
    parser.add_argument("--fd", type=int)
    parser.add_argument("--threads", type=int)
    parser.add_argument("--data", type=Path)
    parser.add_argument("--memory", type=int)
    parser.add_argument("--require-sandbox", action="store_true")
    parser.add_argument("--json", action="store_true")
    parser.add_argument("--build", default="fake-1")
    arguments = parser.parse_args()
    if arguments.command == "info":
        print(json.dumps({"build": arguments.build, "protocol_version": PROTOCOL_VERSION}))
        return
    FakeEngine(socket.socket(fileno=arguments.fd), arguments.threads, arguments.build).run()


if __name__ == "__main__":
    main()
