"""Following a job: a bar with samples, error and time left on a terminal, plain lines elsewhere."""

import sys
import time
from collections.abc import Callable
from typing import Any, TextIO

from fluxfarm.cli.client import ServiceClient
from fluxfarm.cli.exits import CommandError, Exit

TERMINAL_STATES = ("SUCCEEDED", "FAILED", "CANCELLED")
# A service whose engine processes do not start is given this long.
BROKEN_PATIENCE_S = 5.0


def follow(client: ServiceClient, job_id: str, out: TextIO = sys.stderr) -> dict[str, Any]:
    """Show progress until the job ends; returns its last state. Warnings are shown as they come."""
    if out.isatty():
        from fluxfarm.cli.bar import Bar

        with Bar(out) as bar:
            return _poll(client, job_id, bar.show)
    lines = PlainLines(out)
    return _poll(client, job_id, lines.show)


def outcome(job: dict[str, Any]) -> None:
    """Return if the job succeeded, else raise the CommandError for how it ended."""
    if job["state"] == "FAILED":
        raise CommandError(Exit.JOB_FAILED, f"job {job['id']} failed: {job['reason']}")
    if job["state"] != "SUCCEEDED":
        raise CommandError(Exit.CANCELLED, f"job {job['id']}: {job['state']}")


class PlainLines:
    """One line when the pass or the state changes, at most one a second."""

    def __init__(self, out: TextIO) -> None:
        self._out = out
        self._shown: tuple[str, int] | None = None
        self._warnings = 0
        self._next_s = 0.0

    def show(self, job: dict[str, Any]) -> None:
        """Print what is new."""
        for warning in job["warnings"][self._warnings :]:
            print(f"warning: {warning}", file=self._out, flush=True)
        self._warnings = len(job["warnings"])
        key = (job["state"], job["progress"]["pass"])
        ended = job["state"] in TERMINAL_STATES
        if key != self._shown and (ended or time.monotonic() >= self._next_s):
            self._shown, self._next_s = key, time.monotonic() + 1.0
            print(describe(job), file=self._out, flush=True)


def describe(job: dict[str, Any]) -> str:
    """State, pass, samples per pixel, error and time left in one line."""
    parts = [job["state"]]
    progress = job["progress"]
    if progress["pass"]:
        parts.append(f"pass {progress['pass']}")
        parts.append(f"{samples_per_pixel(job):.4g} samples per pixel")
    if progress["error_now"] is not None:
        parts.append(f"error {progress['error_now']:.3g}")
    if progress["eta_seconds"] is not None:
        parts.append(f"{progress['eta_seconds']:.0f} s left")
    return ", ".join(parts)


def samples_per_pixel(job: dict[str, Any]) -> float:
    """Mean over the rendered part of the frame."""
    area = 0 if job["crop"] is None else job["crop"]["width"] * job["crop"]["height"]
    return float(job["progress"]["samples_done"] / area) if area else 0.0


def _poll(client: ServiceClient, job_id: str, show: Callable[[dict[str, Any]], None]) -> dict[str, Any]:
    started = time.monotonic()
    while True:
        job: dict[str, Any] = client.call("GET", f"/v1/jobs/{job_id}", headers={"Prefer": "wait=1"})
        show(job)
        if job["state"] in TERMINAL_STATES:
            return job
        if job["state"] == "QUEUED" and time.monotonic() - started > BROKEN_PATIENCE_S:
            trouble = client.healthy()
            if trouble is not None:
                workers = client.call("GET", "/v1/workers")["workers"]
                raise CommandError(Exit.UNREACHABLE, f"{trouble}: {workers[0]['last_words']}")
