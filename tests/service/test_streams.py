"""Events and frames."""

import asyncio
import json
import re
import socket
import threading
import time
from pathlib import Path
from types import SimpleNamespace
from typing import Any

from farm_client import Client

from fluxfarm.api.streams import pull_events
from fluxfarm.domain.events import Event, EventKind
from fluxfarm.domain.job import JobState
from fluxfarm.orchestrator.watch import Watch

SCENE = "fake: size 64 64\nfake: spp 32\nfake: tile_seconds 0.01\n"


def read_sse(client: Client, job_id: str, after: int | None, most: int) -> list[tuple[int, str, dict[str, Any]]]:
    """Up to `most` server-sent events, then the connection is dropped."""
    found: list[tuple[int, str, dict[str, Any]]] = []
    headers = {} if after is None else {"Last-Event-ID": str(after)}
    with client.http.stream("GET", f"/v1/jobs/{job_id}/events", headers=headers) as reply:
        assert reply.headers["content-type"].startswith("text/event-stream")
        event: dict[str, str] = {}
        for line in reply.iter_lines():
            if line:
                name, _, value = line.partition(": ")
                event[name] = value
                continue
            if "id" in event:
                found.append((int(event["id"]), event["event"], json.loads(event["data"])))
            event = {}
            if len(found) == most:
                break
    return found


def test_reader_that_is_cut_off_and_reconnects_misses_nothing(client: Client) -> None:
    job_id = client.submit(SCENE)
    read: list[tuple[int, str, dict[str, Any]]] = []
    while not read or read[-1][1] != "end":
        read += read_sse(client, job_id, read[-1][0] if read else None, 17)
    assert [event[0] for event in read] == list(range(1, len(read) + 1))
    states = [event[2]["state"] for event in read if event[1] == "state"]
    assert states == ["QUEUED", "PREPARING", "RUNNING", "FINALIZING", "SUCCEEDED"]
    assert sum(event[1] == "tile" for event in read) == 16 * 6
    samples = [event[2]["samples"] for event in read if event[1] == "pass"]
    assert samples == sorted(set(samples))
    assert samples[-1] == 32


def test_json_lines_tell_the_same_as_server_sent_events(client: Client) -> None:
    job_id = client.submit("fake: spp 2\nfake: warn a lamp without power\n")
    lines = client.events(job_id)
    events = read_sse(client, job_id, None, 1000)
    assert [(line["id"], line["event"]) for line in lines] == [event[:2] for event in events]
    assert {"message": "a lamp without power"} in [line["data"] for line in lines]
    assert client.job(job_id)["warnings"] == ["a lamp without power"]


def test_reading_after_the_end_ends_at_once(client: Client) -> None:
    job_id = client.submit("fake: spp 1\n")
    last = client.events(job_id)[-1]["id"]
    assert client.events(job_id, after=last) == []


def test_bad_last_event_id_is_a_problem(client: Client) -> None:
    job_id = client.submit("fake: spp 1\n")
    reply = client.http.get(f"/v1/jobs/{job_id}/events", headers={"Last-Event-ID": "-1"})
    assert (reply.status_code, reply.json()["field"]) == (422, "Last-Event-ID")


def test_end_that_falls_between_two_readings_is_not_missed() -> None:
    end = Event(1, EventKind.END, 0.0, {"state": "SUCCEEDED"})

    class EndsWhileRead:
        readings = 0

        async def events_after(self, job_id: str, seq: int, limit: int) -> list[Event]:
            self.readings += 1
            return [] if self.readings == 1 else [end]

        async def job(self, job_id: str) -> Any:
            return SimpleNamespace(state=JobState.SUCCEEDED)

    async def read() -> list[Event | None]:
        farm: Any = SimpleNamespace(orchestrator=SimpleNamespace(watch=Watch()), ledger=EndsWhileRead())
        return [event async for event in pull_events(farm, "job", 0)]

    assert asyncio.run(read()) == [end]


def parts(body: bytes, content_type: str) -> list[tuple[dict[str, str], bytes]]:
    """The parts of a multipart body, by their Content-Length alone."""
    boundary = re.search(r"boundary=(\S+)", content_type)
    assert boundary is not None
    mark = b"--" + boundary[1].encode()
    found, rest = [], body
    while not rest.startswith(mark + b"--\r\n"):
        assert rest.startswith(mark + b"\r\n")
        head, _, rest = rest[len(mark) + 2 :].partition(b"\r\n\r\n")
        headers = dict(line.split(": ", 1) for line in head.decode().lower().split("\r\n"))
        length = int(headers["content-length"])
        found.append((headers, rest[:length]))
        assert rest[length : length + 2] == b"\r\n"
        rest = rest[length + 2 :]
    return found


def test_frames_are_complete_images_whose_samples_rise(client: Client) -> None:
    job_id = client.submit(SCENE)
    reply = client.http.get(f"/v1/jobs/{job_id}/frames")
    assert reply.headers["content-type"].startswith("multipart/mixed")
    found = parts(reply.content, reply.headers["content-type"])
    assert len(found) >= 3
    samples = [int(headers["x-fluxfarm-samples"]) for headers, _ in found]
    assert samples == sorted(set(samples))
    assert samples[-1] == 32
    assert all(image[:4] == b"\x76\x2f\x31\x01" for _, image in found)
    assert found[-1][1] == client.http.get(f"/v1/jobs/{job_id}/image.exr").content
    late = client.http.get(f"/v1/jobs/{job_id}/frames")
    assert len(parts(late.content, late.headers["content-type"])) == 1


def test_slow_readers_neither_stop_the_job_nor_lose_its_end(client: Client) -> None:
    job_id = client.submit("fake: size 64 64\nfake: spp 16\n")
    host, port = client.url.removeprefix("http://").split(":")
    readers = []
    for path in ("frames", "events"):
        reader = socket.create_connection((host, int(port)))
        reader.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 1024)
        reader.sendall(f"GET /v1/jobs/{job_id}/{path} HTTP/1.1\r\nHost: x\r\nConnection: close\r\n\r\n".encode())
        readers.append(reader)
    client.succeed(job_id)
    for reader, end in zip(readers, (b"--\r\n", b"event: end"), strict=True):
        body = b""
        while chunk := reader.recv(1 << 16):
            body += chunk
        assert end in body[-400:]
        reader.close()


def test_many_watchers_hear_the_end_together(client: Client) -> None:
    job_id = client.submit("fake: size 64 64\nfake: spp 8\nfake: tile_seconds 0.01\n")
    ends: list[float] = []

    def watch() -> None:
        other = Client(client.url)
        assert other.events(job_id)[-1]["event"] == "end"
        ends.append(time.monotonic())
        other.http.close()

    threads = [threading.Thread(target=watch) for _ in range(20)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join(30)
    assert len(ends) == 20
    assert max(ends) - min(ends) < 2


def test_memory_does_not_grow_with_a_reader_that_never_reads(client: Client) -> None:
    def resident_mib() -> float:
        pages = int(Path("/proc/self/statm").read_text().split()[1])
        return pages * 4096 / 2**20

    client.succeed(client.submit("fake: size 160 160\nfake: spp 1\n"))
    host, port = client.url.removeprefix("http://").split(":")
    before = resident_mib()
    job_id = client.submit("fake: size 160 160\nfake: spp 4\n")
    stuck = []
    for _ in range(20):
        reader = socket.create_connection((host, int(port)))
        reader.sendall(f"GET /v1/jobs/{job_id}/events HTTP/1.1\r\nHost: x\r\n\r\n".encode())
        stuck.append(reader)
    client.succeed(job_id)
    assert resident_mib() - before < 60
    for reader in stuck:
        reader.close()
