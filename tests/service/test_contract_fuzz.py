"""Requests that schemathesis makes up for each route of the OpenAPI file: never a 5xx, and replies as the file says."""

from collections.abc import Callable
from typing import Any

import pytest
import schemathesis
from farm_client import Client
from hypothesis import HealthCheck, Phase
from hypothesis import settings as hypothesis_settings
from schemathesis.checks import not_a_server_error
from schemathesis.core.failures import FailureGroup
from schemathesis.specs.openapi.checks import (
    content_type_conformance,
    response_schema_conformance,
    status_code_conformance,
)

from fluxfarm.app import create_app
from fluxfarm.settings import OWNER_KEY_FILE, Settings

CHECKS = [not_a_server_error, content_type_conformance, response_schema_conformance, status_code_conformance]


schema = schemathesis.openapi.from_dict(create_app().openapi())


@pytest.fixture
def locked(start: Callable[..., Client], settings: Settings) -> tuple[str, dict[str, str]]:
    """Address of a service that asks for keys, and headers with the owner's."""
    client = start(keys="on")
    key = (settings.data / OWNER_KEY_FILE).read_text().strip()
    return client.url, {"Authorization": f"Bearer {key}"}


def of_each_route(examples: int) -> hypothesis_settings:
    return hypothesis_settings(
        max_examples=examples,
        deadline=None,
        suppress_health_check=list(HealthCheck),
        phases=[Phase.explicit, Phase.generate],
    )


@schema.parametrize()
@of_each_route(10)
def test_no_request_makes_an_error_of_the_service(case: Any, locked: tuple[str, dict[str, str]]) -> None:
    url, headers = locked
    case.call_and_validate(base_url=url, headers=headers, checks=CHECKS, timeout=30)


@pytest.mark.slow
@schema.parametrize()
@of_each_route(1000)
def test_no_request_of_many_makes_an_error_of_the_service(case: Any, locked: tuple[str, dict[str, str]]) -> None:
    url, headers = locked
    case.call_and_validate(base_url=url, headers=headers, checks=CHECKS, timeout=30)


@pytest.mark.parametrize(
    "promise",
    [
        {"404": {"description": "Never sent."}},
        {"200": {"description": "Of another type.", "content": {"text/plain": {}}}},
        {"200": {"description": "Of another form.", "content": {"application/json": {"schema": {"type": "array"}}}}},
    ],
    ids=["status", "type", "form"],
)
def test_reply_that_is_not_as_the_file_says_is_found(promise: Any, locked: tuple[str, dict[str, str]]) -> None:
    document = create_app().openapi()
    document["paths"]["/v1/workers"]["get"]["responses"] = promise
    url, headers = locked
    case = schemathesis.openapi.from_dict(document)["/v1/workers"]["GET"].Case()
    with pytest.raises(FailureGroup):
        case.call_and_validate(base_url=url, headers=headers, checks=CHECKS, timeout=30)
