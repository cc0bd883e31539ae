"""API keys: every route asks, scopes and owners are kept apart, quotas hold, and no secret is left anywhere."""

import re
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from dataclasses import replace
from pathlib import Path
from typing import Any

import httpx2
import pytest
from farm_client import Client
from typer.testing import CliRunner

from fluxfarm.api.access import scope_of
from fluxfarm.app import create_app
from fluxfarm.cli.commands import app as command
from fluxfarm.cli.embedded import EmbeddedService
from fluxfarm.domain.access import Scope, seconds_until_below
from fluxfarm.settings import OWNER_KEY_FILE, Settings

SCENE = "fake: size 32 32\n"
SLOW = "fake: size 32 32\nfake: tile_seconds 30\n"

# Every route of the published contract, so that a new one cannot be forgotten.
ROUTES = [
    (method.upper(), re.sub(r"\{number\}", "1", re.sub(r"\{sha256\}", "0" * 64, path)), route["tags"])
    for path, methods in create_app().openapi()["paths"].items()
    for method, route in methods.items()
]


def bearer(key: str) -> dict[str, str]:
    return {"Authorization": f"Bearer {key}"}


def owner_key(settings: Settings) -> str:
    return (settings.data / OWNER_KEY_FILE).read_text().strip()


@pytest.fixture
def locked(start: Callable[..., Client], settings: Settings) -> Client:
    """A service that asks for keys; the client has the owner's."""
    client = start(keys="on")
    client.http.headers |= bearer(owner_key(settings))
    return client


@pytest.fixture
def with_key(locked: Client) -> Iterator[Callable[..., Client]]:
    """Makes a key and a client that has it: `with_key("submit", jobs=1)`."""
    with ExitStack() as stack:

        def made(scope: str, **quota: int) -> Client:
            reply = locked.http.post("/v1/keys", json={"name": f"for {scope}", "scope": scope, "quota": quota})
            assert reply.status_code == 201, reply.text
            client = Client(locked.url)
            stack.callback(client.http.close)
            client.http.headers |= bearer(reply.json()["key"])
            return client

        yield made


def test_every_route_answers_401_without_a_key_that_it_knows(locked: Client) -> None:
    assert len(ROUTES) > 20
    for method, path, _ in ROUTES:
        for headers in ({}, bearer("fluxfarm_guessed"), {"Authorization": "Basic abc"}):
            reply = httpx2.request(method, locked.url + path, headers=headers)
            assert reply.status_code == 401, (method, path, headers, reply.text)
            assert reply.json()["type"].endswith(":unauthorized")
            assert reply.headers["www-authenticate"].startswith("Bearer")
        query = httpx2.request(
            method, locked.url + path, params={"key": locked.http.headers["Authorization"].split()[1]}
        )
        assert query.status_code == 401, "a key in a URL ends up in logs and must not open anything"


@pytest.mark.parametrize("scope", ["read", "submit"])
def test_every_route_beyond_the_scope_of_a_key_answers_403(with_key: Callable[..., Client], scope: str) -> None:
    client = with_key(scope)
    refused = 0
    for method, path, tags in ROUTES:
        reply = client.http.request(method, path)
        beyond = not Scope(scope).allows(scope_of(method, tags))
        assert (reply.status_code == 403) == beyond, (method, path, reply.text)
        refused += beyond
    assert refused == {"read": 10, "submit": 3}[scope]


def test_keys_are_asked_for_where_other_machines_reach_the_service(settings: Settings) -> None:
    hosts = {"127.0.0.1": False, "127.0.0.2": False, "::1": False, "localhost": False}
    hosts |= {"0.0.0.0": True, "::": True, "192.0.2.7": True, "farm.example": True}
    for host, asked in hosts.items():
        assert replace(settings, host=host).asks_for_keys is asked, host
        assert replace(settings, host=host, keys="on").asks_for_keys
        assert not replace(settings, host=host, keys="off").asks_for_keys


def test_without_keys_nobody_is_asked_and_none_can_be_made(client: Client) -> None:
    assert client.http.get("/v1/jobs").status_code == 200
    assert client.http.get("/v1/keys").status_code == 404
    job_id = client.submit(SCENE)
    assert client.job(job_id)["owner"] is None


def test_secrets_are_in_the_owners_file_and_nowhere_else(
    settings: Settings, locked: Client, with_key: Callable[..., Client], caplog: pytest.LogCaptureFixture
) -> None:
    other = with_key("submit")
    other.render(SCENE)
    assert locked.http.get("/v1/jobs").status_code == 200
    owner, secret = owner_key(settings), other.http.headers["Authorization"].split()[1]
    assert (settings.data / OWNER_KEY_FILE).stat().st_mode & 0o777 == 0o600
    files = [path for path in settings.data.rglob("*") if path.is_file() and path.name != OWNER_KEY_FILE]
    assert any(path.name.startswith("ledger") for path in files)
    for path in files:
        content = path.read_bytes()
        assert owner.encode() not in content, path
        assert secret.encode() not in content, path
    assert owner not in caplog.text
    assert secret not in caplog.text
    assert secret not in locked.http.get("/v1/keys").text


def test_owners_key_stays_over_a_restart_and_is_renewed_when_its_file_is_removed(settings: Settings) -> None:
    def reply_to(key: str) -> int:
        with EmbeddedService(replace(settings, keys="on")) as service:
            return httpx2.get(service.url + "/v1/jobs", headers=bearer(key)).status_code

    assert reply_to("none") == 401
    first = owner_key(settings)
    assert reply_to(first) == 200
    assert owner_key(settings) == first
    (settings.data / OWNER_KEY_FILE).unlink()
    assert reply_to(first) == 401
    assert reply_to(owner_key(settings)) == 200


def test_dropped_key_opens_nothing_and_the_owners_cannot_be_dropped(
    locked: Client, with_key: Callable[..., Client]
) -> None:
    client = with_key("read")
    assert client.http.get("/v1/jobs").status_code == 200
    listed = {key["name"]: key["id"] for key in locked.http.get("/v1/keys").json()["keys"]}
    assert locked.http.delete(f"/v1/keys/{listed['for read']}").status_code == 204
    assert client.http.get("/v1/jobs").status_code == 401
    assert locked.http.delete(f"/v1/keys/{listed['for read']}").status_code == 404
    assert locked.http.delete(f"/v1/keys/{listed['owner']}").status_code == 403


def test_job_is_steered_by_its_own_key_and_by_admins_only(locked: Client, with_key: Callable[..., Client]) -> None:
    mine, other = with_key("submit"), with_key("submit")
    job_id = mine.submit(SLOW)
    owners = {key["id"]: key["name"] for key in locked.http.get("/v1/keys").json()["keys"]}
    assert owners[other.job(job_id)["owner"]] == "for submit"
    for method, path in (("POST", ":pause"), ("POST", ":resume"), ("POST", ":cancel"), ("DELETE", "")):
        reply = other.http.request(method, f"/v1/jobs/{job_id}{path}")
        assert reply.status_code == 403, reply.text
        assert "submitted with another key" in reply.json()["detail"]
    assert mine.http.post(f"/v1/jobs/{job_id}:pause").status_code == 200
    assert locked.http.post(f"/v1/jobs/{job_id}:cancel").status_code == 200
    assert mine.http.delete(f"/v1/jobs/{job_id}").status_code == 204


def test_idempotency_keys_of_two_owners_do_not_meet(with_key: Callable[..., Client]) -> None:
    ids = []
    for client in (with_key("submit"), with_key("submit")):
        replies = [
            client.http.post("/v1/jobs", json=client.job_body(SCENE), headers={"Idempotency-Key": "frame 1"})
            for _ in range(2)
        ]
        assert [reply.status_code for reply in replies] == [201, 200]
        ids += [reply.json()["id"] for reply in replies]
    assert len(set(ids)) == 2


def refusal(reply: Any, *words: str) -> None:
    """The reply is a 429 that says when to come again and why."""
    assert reply.status_code == 429, reply.text
    assert int(reply.headers["retry-after"]) > 0
    for word in words:
        assert word in reply.json()["detail"]


def test_quota_of_jobs_counts_unfinished_ones(with_key: Callable[..., Client]) -> None:
    client = with_key("submit", jobs=1)
    first = client.submit(SLOW)
    refusal(client.http.post("/v1/jobs", json=client.job_body(SCENE)), "1 unfinished job", "expected fewer than 1")
    again = client.http.post(f"/v1/jobs/{first}:cancel")
    assert again.status_code == 200
    client.render(SCENE)


def test_quota_of_bytes_counts_what_was_sent(locked: Client, with_key: Callable[..., Client]) -> None:
    client = with_key("submit", bytes_a_day=1000)
    client.upload("a" * 600)
    reply = client.http.put(f"/v1/assets/{'1' * 64}", content=b"b" * 600)
    refusal(reply, "400 bytes left")
    refusal(client.http.put(f"/v1/assets/{'1' * 64}", content=b"c"), "used 1200 uploaded bytes", "at most 1000")
    usage = [key["usage"] for key in locked.http.get("/v1/keys").json()["keys"] if key["name"] == "for submit"]
    assert usage == [{"jobs": 0, "bytes": 1200, "samples": 0}]


def test_quota_of_samples_counts_what_was_taken_and_what_is_asked_for(
    locked: Client, with_key: Callable[..., Client]
) -> None:
    client = with_key("submit", samples_a_day=32 * 32 * 10)
    body = client.job_body(SCENE, size={"width": 32, "height": 32}, goal={"spp": 8})
    job = client.http.post("/v1/jobs", json=body).json()
    assert client.succeed(job["id"])["progress"]["samples_done"] == 8192
    assert client.http.delete(f"/v1/jobs/{job['id']}").status_code == 204  # what was taken stays counted
    refusal(client.http.post("/v1/jobs", json=body), "used 8192 camera samples", "asks for 8192", "at most 10240")
    usage = [key["usage"] for key in locked.http.get("/v1/keys").json()["keys"] if key["name"] == "for submit"]
    assert usage == [{"jobs": 0, "bytes": len(SCENE), "samples": 8192}]
    body["goal"] = {"spp": 2}
    assert client.http.post("/v1/jobs", json=body).status_code == 201


def test_day_is_left_hour_by_hour() -> None:
    used = [(100, 5), (101, 3), (110, 4)]
    now = 110 * 3600 + 60
    assert seconds_until_below(used, 8, now) == (100 + 25) * 3600 - now
    assert seconds_until_below(used, 7, now) == (101 + 25) * 3600 - now
    assert seconds_until_below(used, 0, now) == (110 + 25) * 3600 - now
    assert seconds_until_below([], 0, now) == 1


def test_commands_carry_the_key_of_the_environment(
    locked: Client, settings: Settings, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def run(*words: str) -> tuple[int, str]:
        result = CliRunner().invoke(command, list(words))
        return result.exit_code, result.output + str(result.exception or "")

    (tmp_path / "scene.xml").write_text(SCENE)
    monkeypatch.setenv("FLUXFARM_SERVER", locked.url)
    code, text = run("submit", str(tmp_path / "scene.xml"))
    assert code != 0
    assert "no API key" in text
    assert "set FLUXFARM_API_KEY" in text
    monkeypatch.setenv("FLUXFARM_API_KEY", owner_key(settings))
    code, key = run("keys", "add", "Ada", "--scope", "submit", "--jobs", "3")
    assert code == 0
    monkeypatch.setenv("FLUXFARM_API_KEY", key.strip())
    assert run("submit", str(tmp_path / "scene.xml"))[0] == 0
    assert run("keys", "list")[0] != 0
    monkeypatch.setenv("FLUXFARM_API_KEY", owner_key(settings))
    _, listed = run("keys", "list")
    line = next(line for line in listed.splitlines() if "Ada" in line)
    assert run("keys", "drop", line.split()[0])[0] == 0
    assert "Ada" not in run("keys", "list")[1]


def test_commands_find_the_key_of_this_users_own_service(
    locked: Client, settings: Settings, monkeypatch: pytest.MonkeyPatch
) -> None:
    port = locked.url.rsplit(":", 1)[1]
    for name, value in (("DATA", str(settings.data)), ("HOST", "0.0.0.0"), ("PORT", port)):
        monkeypatch.setenv(f"FLUXFARM_{name}", value)
    assert CliRunner().invoke(command, ["list"]).exit_code == 0
    # To a service that is named it is not sent: it may be somebody else's.
    assert CliRunner().invoke(command, ["list", "--server", locked.url]).exit_code != 0
