"""Bad requests: each is one clear problem, and the service goes on."""

import hashlib
import json
from typing import Any

import pytest
from farm_client import Client, fake_engine

from fluxfarm.cli.embedded import EmbeddedService
from fluxfarm.settings import Settings

PROBLEM = "urn:fluxfarm:problem:"
SHA = "a" * 64
BAD_MEMBERS: list[tuple[str, dict[str, Any], str]] = [
    ("unknown member", {"sampels": 3}, "sampels"),
    ("unknown member that cannot be written", {"\ud800": 3}, "body"),
    ("negative samples", {"goal": {"spp": -1}}, "goal.spp"),
    ("no samples", {"goal": {"spp": 0}}, "goal.spp"),
    ("fractional samples", {"goal": {"spp": 2.5}}, "goal.spp"),
    ("samples as text", {"goal": {"spp": "8"}}, "goal.spp"),
    ("samples as truth", {"goal": {"spp": True}}, "goal.spp"),
    ("too many samples", {"goal": {"spp": 10**12}}, "goal.spp"),
    ("two goals", {"goal": {"spp": 8, "seconds": 2}}, "goal"),
    ("empty goal", {"goal": {}}, "goal"),
    ("error of zero", {"goal": {"rel_error": 0}}, "goal.rel_error"),
    ("negative time", {"goal": {"seconds": -2.0}}, "goal.seconds"),
    ("size of zero", {"size": {"width": 0, "height": 10}}, "size.width"),
    ("size of a million", {"size": {"width": 10**6, "height": 10**6}}, "size.width"),
    ("size of too many pixels", {"size": {"width": 65536, "height": 65536}}, "size"),
    ("half a size", {"size": {"width": 10}}, "size.height"),
    ("crop outside", {"size": {"width": 8, "height": 8}, "crop": {"x": 4, "y": 0, "width": 8, "height": 8}}, "crop"),
    ("negative crop", {"crop": {"x": -1, "y": 0, "width": 8, "height": 8}}, "crop.x"),
    ("unknown method", {"integrator": "magic"}, "integrator"),
    ("negative seed", {"seed": -1}, "seed"),
    ("seed beyond JSON", {"seed": 2**60}, "seed"),
    ("control characters", {"name": "a\x00b"}, "name"),
    ("unknown limit", {"limits": {"memory": 1}}, "limits.memory"),
    ("no scene", {"scene": None}, "scene"),
    ("bundle and builtin", {"scene": {"builtin": "cornell", "entry": "a", "files": {"a": SHA}}}, "scene"),
    ("entry alone", {"scene": {"entry": "a"}}, "scene"),
    ("unknown builtin", {"scene": {"builtin": "../cornell"}}, "scene.builtin"),
    ("entry that is not listed", {"scene": {"entry": "b", "files": {"a": SHA}}}, "scene.entry"),
    ("no digest", {"scene": {"entry": "a", "files": {"a": "abc"}}}, "scene.files"),
    ("no files", {"scene": {"entry": "a", "files": {}}}, "scene.files"),
    ("file that is a folder", {"scene": {"entry": "a", "files": {"a": SHA, "a/b": SHA}}}, "scene.files"),
]


@pytest.fixture(scope="module")
def shared(tmp_path_factory: pytest.TempPathFactory) -> Any:
    """One service for all bad requests: it has to survive every one of them."""
    folder = tmp_path_factory.mktemp("bad")
    program = fake_engine(folder)
    with EmbeddedService(
        Settings(data=folder / "data", port=0, engine=str(program), max_asset_bytes=1 << 20)
    ) as service:
        client = Client(service.url)
        yield client
        client.succeed(client.submit("fake: spp 1\n"))
        assert len(client.http.get("/v1/jobs").json()["jobs"]) == 1
        client.http.close()


def check_problem(reply: Any, status: int, code: str) -> dict[str, Any]:
    assert reply.status_code == status, reply.text
    assert reply.headers["content-type"] == "application/problem+json"
    problem: dict[str, Any] = reply.json()
    assert problem["type"] == PROBLEM + code
    assert problem["status"] == status
    assert problem["detail"]
    return problem


@pytest.mark.parametrize(
    ("members", "field"), [case[1:] for case in BAD_MEMBERS], ids=[case[0] for case in BAD_MEMBERS]
)
def test_malformed_job_names_the_member_and_what_is_right(shared: Client, members: dict[str, Any], field: str) -> None:
    body = json.dumps({"scene": {"entry": "a", "files": {"a": SHA}}, **members})
    reply = shared.http.post("/v1/jobs", content=body, headers={"Content-Type": "application/json"})
    assert reply.status_code == 422, reply.text
    problem = reply.json()
    fields = [error["field"] for error in problem.get("errors", [])] or [problem["field"]]
    assert any(name == field or name.startswith(f"{field}[") for name in fields), problem
    assert f"{fields[0]} = " in problem["detail"]


@pytest.mark.parametrize(
    "path",
    [
        "../a",
        "/etc/passwd",
        "a/../../b",
        "a//b",
        "./a",
        "a\\b",
        "C:/a",
        "",
        "a\x00b",
        "x" * 600,
        "\ud800",
        "a/" + "b" * 300,
    ],
)
def test_path_that_leaves_the_bundle_is_refused(shared: Client, path: str) -> None:
    body = json.dumps({"scene": {"entry": path, "files": {path: SHA}}})
    reply = shared.http.post("/v1/jobs", content=body, headers={"Content-Type": "application/json"})
    assert reply.status_code == 422, reply.text
    assert "expected" in reply.json()["detail"]


def test_missing_files_are_a_conflict_that_lists_them(shared: Client) -> None:
    stored = shared.upload("fake: spp 1\n")
    files = {"scene.xml": stored, "a.ply": SHA, "b.ply": "b" * 64}
    reply = shared.http.post("/v1/jobs", json={"scene": {"entry": "scene.xml", "files": files}})
    problem = check_problem(reply, 409, "assets-missing")
    assert problem["missing"] == {"a.ply": SHA, "b.ply": "b" * 64}
    wanted = shared.http.post("/v1/assets:missing", json={"sha256": [SHA, stored, SHA]})
    assert wanted.json() == {"missing": [SHA]}


@pytest.mark.parametrize("opening", ["[", '{"a":', '{"scene":['])
def test_deep_nesting_is_refused_before_it_is_parsed(shared: Client, opening: str) -> None:
    reply = shared.http.post("/v1/jobs", content=opening * 100_000, headers={"Content-Type": "application/json"})
    assert "nested deeper than 64 levels" in check_problem(reply, 422, "malformed-request")["detail"]


def test_brackets_inside_text_are_not_nesting(shared: Client) -> None:
    body = {"name": '["{' * 60, "scene": {"entry": "a", "files": {"a": SHA}}}
    check_problem(shared.http.post("/v1/jobs", json=body), 409, "assets-missing")


@pytest.mark.parametrize(
    "text", ["", "{", '{"scene": }', "nonsense", '{"goal": {"rel_error": NaN}}', "\xff\xfe", "\x80"]
)
def test_broken_json_is_a_problem(shared: Client, text: str) -> None:
    reply = shared.http.post("/v1/jobs", content=text.encode("latin-1"), headers={"Content-Type": "application/json"})
    check_problem(reply, 422, "malformed-request")


def test_body_that_is_too_long_is_refused(shared: Client) -> None:
    reply = shared.http.post("/v1/jobs", content=b" " * (5 << 20), headers={"Content-Type": "application/json"})
    check_problem(reply, 413, "too-large")


def test_asset_with_other_bytes_than_its_digest_is_refused(shared: Client) -> None:
    check_problem(shared.http.put(f"/v1/assets/{SHA}", content=b"other"), 422, "digest-mismatch")
    assert shared.http.post("/v1/assets:missing", json={"sha256": [SHA]}).json() == {"missing": [SHA]}
    assert shared.http.put("/v1/assets/..%2F..%2Fetc", content=b"").status_code in (404, 422)
    assert shared.http.put(f"/v1/assets/{'A' * 64}", content=b"").status_code == 422


def test_asset_that_is_too_long_is_refused(shared: Client) -> None:
    body = bytes(2 << 20)
    sha256 = hashlib.sha256(body).hexdigest()
    check_problem(shared.http.put(f"/v1/assets/{sha256}", content=body), 413, "too-large")
    chunked = (body[at : at + 65536] for at in range(0, len(body), 65536))
    check_problem(shared.http.put(f"/v1/assets/{sha256}", content=chunked), 413, "too-large")


def test_asset_sent_twice_is_stored_once(shared: Client) -> None:
    body = b"fake: spp 1\n# twice\n"
    address = f"/v1/assets/{hashlib.sha256(body).hexdigest()}"
    assert [shared.http.put(address, content=body).status_code for _ in range(3)] == [201, 200, 200]


def test_unknown_addresses_methods_and_jobs_are_problems(shared: Client) -> None:
    check_problem(shared.http.get("/v1/nothing"), 404, "not-found")
    check_problem(shared.http.get("/v1/jobs/nobody"), 404, "job-not-found")
    check_problem(shared.http.post("/v1/jobs/nobody:cancel"), 404, "job-not-found")
    check_problem(shared.http.get("/v1/jobs/nobody/events"), 404, "job-not-found")
    check_problem(shared.http.get("/v1/jobs/nobody/frames"), 404, "job-not-found")
    check_problem(shared.http.patch("/v1/jobs"), 405, "method-not-allowed")
    assert shared.http.get("/v1/jobs?limit=0").status_code == 422
    assert shared.http.get("/v1/jobs?state=ASLEEP").status_code == 422
