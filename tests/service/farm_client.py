"""Talking to a service in the words of the tests, and running one as a process of its own."""

import hashlib
import json
import os
import stat
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import httpx2

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


def fake_engine(folder: Path) -> Path:
    """The fake engine as a program in `folder`."""
    program = folder / "fake-engine"
    program.write_text(f'#!/bin/sh\nexec "{sys.executable}" "{FAKE_ENGINE}" "$@"\n')
    program.chmod(program.stat().st_mode | stat.S_IXUSR)
    return program


class ServiceProcess:
    """`fluxfarm serve` as a process of its own, so that it can be killed."""

    def __init__(self, settings: Settings, workers: int) -> None:
        environment = {
            **os.environ,
            "FLUXFARM_DATA": str(settings.data),
            "FLUXFARM_ENGINE": settings.engine,
            "FLUXFARM_PORT": "0",
            "FLUXFARM_TILE_SIZE": str(settings.tile_size),
            "FLUXFARM_WORKERS": str(workers),
            "FLUXFARM_THREADS": "1",
        }
        command = [sys.executable, "-c", "from fluxfarm.cli import main; main()", "serve"]
        self.process = subprocess.Popen(
            command, env=environment, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True
        )
        assert self.process.stdout is not None
        self.line = self.process.stdout.readline()
        self.client = Client(self.line.split()[-1]) if self.line else None

    def end(self, number: int) -> int:
        self.process.send_signal(number)
        status = self.process.wait(20)
        assert self.process.stdout is not None
        self.process.stdout.close()
        if self.client is not None:
            self.client.http.close()
        return status
