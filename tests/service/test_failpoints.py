"""The service killed between any two effects that belong together: nothing is lost, nothing is committed twice."""

import re
import signal
import sqlite3
from collections.abc import Callable
from pathlib import Path
from typing import Any

import httpx2
import pytest
from farm_client import Client, ServiceProcess

import fluxfarm
from fluxfarm.failpoints import FAILPOINTS
from fluxfarm.settings import Settings

SCENE = "fake: size 64 64\nfake: spp 16\n"
TILES, PASSES = 16, 5
# Where the first time would be before anything that can be lost.
COUNTS = {"transaction-open": (1, 2, 3, 6, 10), "tile-synced": (1, 40), "tile-renamed": (1, 40), "output-kept": (1, 5)}
SOURCES = Path(fluxfarm.__file__).parent


def submit(client: Client) -> str:
    """Upload and submit as a careful client does: again and again with the same key, until there is a reply."""
    body = client.job_body(SCENE, seed=3)
    reply = client.http.post("/v1/jobs", json=body, headers={"Idempotency-Key": "the only job"})
    assert reply.status_code in (200, 201), reply.text
    return str(reply.json()["id"])


def killed(settings: Settings, failpoint: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Run a service on the job until it is killed there."""
    monkeypatch.setenv("FLUXFARM_FAILPOINT", failpoint)
    service = ServiceProcess(settings, workers=1)
    monkeypatch.delenv("FLUXFARM_FAILPOINT")
    try:
        if service.client is not None:
            service.client.finish(submit(service.client))
    except (httpx2.HTTPError, ValueError):
        pass
    assert service.process.wait(20) == -signal.SIGKILL, f"{failpoint} was not reached"
    service.end(signal.SIGKILL)


@pytest.mark.parametrize(
    "failpoint", [f"{name}:{count}" for name in FAILPOINTS for count in COUNTS.get(name, (1,))], ids=str
)
def test_service_killed_at_a_failpoint_loses_nothing(
    failpoint: str, start: Callable[..., Client], settings: Settings, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    undisturbed = start(data=tmp_path / "calm").render(SCENE, seed=3)
    killed(settings, failpoint, monkeypatch)
    client = start()
    job_id = submit(client)
    job = client.succeed(job_id)
    assert client.image_digest(job_id) == undisturbed
    assert job["progress"]["samples_done"] == 64 * 64 * 16
    assert [found["id"] for found in client.http.get("/v1/jobs").json()["jobs"]] == [job_id]
    check_events(client.events(job_id))
    check_files(settings, job_id)


def check_events(events: list[dict[str, Any]]) -> None:
    assert [event["id"] for event in events] == list(range(1, len(events) + 1))
    tiles = [
        (event["data"]["pass"], event["data"]["x"], event["data"]["y"]) for event in events if event["event"] == "tile"
    ]
    assert len(tiles) == len(set(tiles)) == TILES * PASSES, "a tile was lost or committed twice"
    revisions = [event["data"]["revision"] for event in events if event["event"] == "pass"]
    assert revisions == list(range(1, len(revisions) + 1))
    assert [event["data"] for event in events if event["event"] == "end"] == [{"state": "SUCCEEDED"}]


def check_files(settings: Settings, job_id: str) -> None:
    """There is a file for each that the ledger names, and no other."""
    with sqlite3.connect(f"file:{settings.data / 'ledger.sqlite3'}?mode=ro", uri=True) as ledger:
        named = {row[0] for row in ledger.execute("SELECT sha256 FROM tiles")}
        for row in ledger.execute("SELECT exr, png, film FROM revisions"):
            named |= {sha256 for sha256 in row if sha256}
    ledger.close()
    folder = settings.data / "jobs" / job_id
    assert {path.name for kind in ("tiles", "outputs") for path in (folder / kind).iterdir()} == named
    assert [path for path in (settings.data / "incoming").iterdir() if path.is_file()] == []


def test_every_failpoint_is_somewhere_and_has_a_sentence() -> None:
    reached = {name for file in SOURCES.rglob("*.py") for name in re.findall(r'reach\("([\w-]+)"\)', file.read_text())}
    assert reached | {"finalizing", "succeeded"} == set(FAILPOINTS)
