"""The published contract: the OpenAPI file is what the routes say, and each route says what a user needs."""

import json
from pathlib import Path

from fluxfarm.app import create_app

PUBLISHED = Path(__file__).resolve().parents[2] / "service" / "openapi.json"


def test_openapi_file_is_what_the_routes_say() -> None:
    published = json.loads(PUBLISHED.read_text())
    assert published == json.loads(json.dumps(create_app().openapi())), (
        "run `.venv/bin/python service/tools/write_openapi.py` and look at the difference"
    )


def test_every_route_has_a_summary_a_description_and_problems() -> None:
    for path, methods in create_app().openapi()["paths"].items():
        for method, route in methods.items():
            assert route.get("summary"), (method, path)
            assert route.get("description"), (method, path)
            if path.startswith("/v1/jobs") or path.startswith("/v1/assets"):
                problems = [reply for status, reply in route["responses"].items() if status.startswith("4")]
                assert problems, (method, path)


def test_design_has_every_route() -> None:
    paths = set(create_app().openapi()["paths"])
    assert paths == {
        "/v1/assets/{sha256}",
        "/v1/assets:missing",
        "/v1/jobs",
        "/v1/jobs/{job_id}",
        "/v1/jobs/{job_id}:cancel",
        "/v1/jobs/{job_id}:pause",
        "/v1/jobs/{job_id}:resume",
        "/v1/jobs/{job_id}/events",
        "/v1/jobs/{job_id}/frames",
        "/v1/jobs/{job_id}/revisions",
        "/v1/jobs/{job_id}/revisions/{number}/image.exr",
        "/v1/jobs/{job_id}/image.exr",
        "/v1/jobs/{job_id}/preview.png",
        "/v1/jobs/{job_id}/tiles/{column}-{row}.exr",
        "/v1/jobs/{job_id}/plan",
        "/v1/jobs/{job_id}/report",
        "/v1/jobs/{job_id}/chart.svg",
        "/v1/keys",
        "/v1/keys/{key_id}",
        "/v1/workers",
        "/v1/system",
        "/healthz",
        "/metrics",
    }
