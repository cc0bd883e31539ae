"""Images over HTTP: entity tags, ranges, tiles, charts."""

import os

from farm_client import Client

SCENE = "fake: size 64 48\nfake: spp 8\n"
PROBLEM = "urn:fluxfarm:problem:"


def test_range_and_entity_tag_give_the_bytes_asked_for(client: Client) -> None:
    job_id = client.submit(SCENE)
    client.succeed(job_id)
    address = f"/v1/jobs/{job_id}/image.exr"
    whole = client.http.get(address)
    tag = whole.headers["etag"]
    assert tag == f'"{client.image_digest(job_id)}"'
    assert whole.headers["accept-ranges"] == "bytes"
    part = client.http.get(address, headers={"Range": "bytes=4-9"})
    assert (part.status_code, part.content) == (206, whole.content[4:10])
    assert part.headers["content-range"] == f"bytes 4-9/{len(whole.content)}"
    last = client.http.get(address, headers={"Range": "bytes=-5", "If-Range": tag})
    assert (last.status_code, last.content) == (206, whole.content[-5:])
    stale = client.http.get(address, headers={"Range": "bytes=0-3", "If-Range": '"other"'})
    assert (stale.status_code, stale.content) == (200, whole.content)
    assert client.http.get(address, headers={"If-None-Match": f'"x", {tag}'}).status_code == 304
    assert client.http.head(address).headers["content-length"] == str(len(whole.content))


def test_strange_ranges_give_the_whole_image_or_a_problem(client: Client) -> None:
    job_id = client.submit(SCENE)
    client.succeed(job_id)
    address = f"/v1/jobs/{job_id}/image.exr"
    many = "bytes=" + ",".join(f"{at}-{at}" for at in range(10_000))
    for text in ("bytes=a-b", "lines=1-2", "bytes=0-1,3-4", many[:60_000]):
        assert client.http.get(address, headers={"Range": text}).status_code == 200
    for text in ("bytes=99999-", "bytes=9-2", "bytes=-0"):
        reply = client.http.get(address, headers={"Range": text})
        assert (reply.status_code, reply.json()["type"]) == (416, PROBLEM + "range-not-satisfiable")
        assert reply.headers["content-range"].startswith("bytes */")


def test_every_revision_stays_and_never_changes(client: Client) -> None:
    job_id = client.submit(SCENE)
    client.succeed(job_id)
    revisions = client.http.get(f"/v1/jobs/{job_id}/revisions").json()["revisions"]
    assert [revision["revision"] for revision in revisions] == list(range(1, len(revisions) + 1))
    for revision in revisions:
        reply = client.http.get(f"/v1/jobs/{job_id}/revisions/{revision['revision']}/image.exr")
        assert reply.headers["etag"] == f'"{revision["sha256"]}"'
        assert len(reply.content) == revision["bytes"]
    reply = client.http.get(f"/v1/jobs/{job_id}/revisions/{len(revisions) + 1}/image.exr")
    assert (reply.status_code, reply.json()["type"]) == (404, PROBLEM + "not-yet-there")


def test_tile_is_an_image_of_its_own_before_and_after_the_end(client: Client) -> None:
    job_id = client.submit("fake: size 64 48\nfake: spp 64\nfake: tile_seconds 0.03\n")
    client.wait_until(job_id, lambda job: job["progress"]["tiles_done"] >= 14)
    running = client.http.get(f"/v1/jobs/{job_id}/tiles/1-1.exr")
    assert (running.status_code, running.content[:4]) == (200, b"\x76\x2f\x31\x01")
    client.http.post(f"/v1/jobs/{job_id}:cancel")
    ended = client.http.get(f"/v1/jobs/{job_id}/tiles/0-0.exr")
    assert (ended.status_code, ended.headers["content-type"]) == (200, "image/x-exr")
    reply = client.http.get(f"/v1/jobs/{job_id}/tiles/4-0.exr")
    assert (reply.status_code, reply.json()["type"]) == (404, PROBLEM + "tile-outside-frame")
    assert client.http.get(f"/v1/jobs/{job_id}/tiles/x-0.exr").status_code == 422


def test_nothing_to_see_yet_is_a_problem(client: Client) -> None:
    job_id = client.submit("fake: load_seconds 2\n")
    for path in ("image.exr", "preview.png", "revisions/1/image.exr", "tiles/0-0.exr", "plan", "chart.svg"):
        reply = client.http.get(f"/v1/jobs/{job_id}/{path}")
        assert (reply.status_code, reply.json()["type"]) == (404, PROBLEM + "not-yet-there"), path


def test_report_and_chart_tell_the_error_over_time(client: Client) -> None:
    job_id = client.submit("fake: size 32 32\nfake: spp 32\nfake: tile_seconds 0.1\n", goal={"rel_error": 0.2})
    client.succeed(job_id)
    report = client.http.get(f"/v1/jobs/{job_id}/report").json()
    assert report["samples"] == 32 * 32 * 32
    assert report["rays"] == report["samples"]
    assert set(report["seconds"]) == {"QUEUED", "PREPARING", "RUNNING", "FINALIZING", "SUCCEEDED"}
    spp = [point["spp"] for point in report["timeline"]]
    assert spp[0] == 1
    assert spp == sorted(spp)
    assert {16, 32} <= set(spp), "both decisions"
    assert report["plan"] == client.http.get(f"/v1/jobs/{job_id}/plan").json()
    chart = client.http.get(f"/v1/jobs/{job_id}/chart.svg")
    assert chart.headers["content-type"].startswith("image/svg+xml")
    assert chart.text.count("<circle") == len(spp) - 1, "one sample has no error"
    assert "goal: error 0.2" in chart.text
    assert "predicted at" in chart.text


def test_system_workers_health_and_metrics_answer(client: Client) -> None:
    job_id = client.submit(SCENE)
    client.succeed(job_id)
    system = client.http.get("/v1/system").json()
    assert system["engine_builds"] == ["fake-1"]
    assert system["sqlite_version"]
    workers = client.http.get("/v1/workers").json()["workers"]
    assert workers[0]["pid"] != os.getpid()
    assert client.http.get("/healthz").json() == {"status": "ok"}
    metrics = client.http.get("/metrics").text
    assert "fluxfarm_tiles_committed_total 48.0" in metrics
    assert 'fluxfarm_jobs{state="SUCCEEDED"} 1.0' in metrics
    assert f"fluxfarm_samples_total {float(client.job(job_id)['progress']['samples_done'])}" in metrics
    assert "fluxfarm_rays_total " in metrics
    assert 'fluxfarm_queue_seconds_bucket{le="+Inf"} 1.0' in metrics
    assert "fluxfarm_error_reached_count " in metrics
    assert job_id not in metrics
