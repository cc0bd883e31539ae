"""A real service on a free port with the fake engine, and small helpers to talk to it."""

import hashlib
import json
import stat
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from dataclasses import replace
from pathlib import Path
from typing import Any

import httpx2
import pytest

from fluxfarm.cli.embedded import EmbeddedService
from fluxfarm.settings import Settings

FAKE_ENGINE = Path(__file__).with_name("fake_engine.py")
TERMINAL = {"SUCCEEDED", "FAILED", "CANCELLED"}


class Client:
    """The HTTP face of one service, in the words of the tests."""

    def __init__(self, url: str) -> None:
        self.url = url
        self.http = httpx2.Client(base_url=url, timeout=30)

    def upload(self, text: str | bytes) -> str:
        body = text.encode() if isinstance(text, str) else text
        sha256 = hashlib.sha256(body).hexdigest()
        assert self.http.put(f"/v1/assets/{sha256}", content=body).status_code in (200, 201)
        return sha256

    def job_body(self, scene: str, **members: Any) -> dict[str, Any]:
        return {"scene": {"entry": "scene.xml", "files": {"scene.xml": self.upload(scene)}}, **members}

    def submit(self, scene: str, **members: Any) -> str:
        reply = self.http.post("/v1/jobs", json=self.job_body(scene, **members))
        assert reply.status_code == 201, reply.text
        return str(reply.json()["id"])

    def job(self, job_id: str) -> dict[str, Any]:
        reply = self.http.get(f"/v1/jobs/{job_id}")
        assert reply.status_code == 200, reply.text
        return dict(reply.json())

    def wait_until(self, job_id: str, done: Callable[[dict[str, Any]], bool], timeout_s: float = 30) -> dict[str, Any]:
        end = time.monotonic() + timeout_s
        while not done(job := self.job(job_id)):
            assert time.monotonic() < end, f"still waiting after {timeout_s} s: {job}"
            time.sleep(0.02)
        return job

    def finish(self, job_id: str, timeout_s: float = 60) -> dict[str, Any]:
        end = time.monotonic() + timeout_s
        while True:
            job = self.http.get(f"/v1/jobs/{job_id}", headers={"Prefer": "wait=10"}).json()
            if job["state"] in TERMINAL:
                return dict(job)
            assert time.monotonic() < end, f"not finished after {timeout_s} s: {job}"

    def succeed(self, job_id: str, timeout_s: float = 60) -> dict[str, Any]:
        job = self.finish(job_id, timeout_s)
        assert job["state"] == "SUCCEEDED", job
        return job

    def events(self, job_id: str, after: int = 0) -> list[dict[str, Any]]:
        headers = {"Accept": "application/jsonl", "Last-Event-ID": str(after)}
        reply = self.http.get(f"/v1/jobs/{job_id}/events", headers=headers)
        assert reply.status_code == 200, reply.text
        return [json.loads(line) for line in reply.text.splitlines()]

    def image_digest(self, job_id: str) -> str:
        reply = self.http.get(f"/v1/jobs/{job_id}/image.exr")
        assert reply.status_code == 200, reply.text
        sha256 = hashlib.sha256(reply.content).hexdigest()
        assert reply.headers["etag"] == f'"{sha256}"'
        return sha256

    def render(self, scene: str, **members: Any) -> str:
        """Submit, wait for success, return the digest of the image."""
        job_id = self.submit(scene, **members)
        self.succeed(job_id)
        return self.image_digest(job_id)


@pytest.fixture
def engine(tmp_path: Path) -> Path:
    """The fake engine as a program."""
    program = tmp_path / "fake-engine"
    program.write_text(f'#!/bin/sh\nexec "{sys.executable}" "{FAKE_ENGINE}" "$@"\n')
    program.chmod(program.stat().st_mode | stat.S_IXUSR)
    return program


@pytest.fixture
def settings(tmp_path: Path, engine: Path) -> Settings:
    """Settings of a service in the test's own folder."""
    return Settings(data=tmp_path / "data", port=0, engine=str(engine), tile_size=16, threads=1)


@pytest.fixture
def start(settings: Settings) -> Iterator[Callable[..., Client]]:
    """Start a service with changed settings: `start(workers=2)`."""
    with ExitStack() as stack:

        def started(**changes: Any) -> Client:
            service = stack.enter_context(EmbeddedService(replace(settings, **changes)))
            client = Client(service.url)
            stack.callback(client.http.close)
            return client

        yield started


@pytest.fixture
def client(start: Callable[..., Client]) -> Client:
    """A running service with one worker."""
    return start()
