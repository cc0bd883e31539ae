"""Errors as RFC 9457 problem replies, all of them from here."""

import json
import logging
from collections.abc import Callable, Sequence
from functools import partial
from http import HTTPStatus
from typing import Any

from fastapi import FastAPI, Request
from fastapi.exceptions import RequestValidationError
from fastapi.responses import Response
from pydantic import BaseModel
from starlette.exceptions import HTTPException

from fluxfarm.errors import BadRequest, FarmError, NotFound, shortened

log = logging.getLogger(__name__)
MEDIA_TYPE = "application/problem+json"
TYPE_PREFIX = "urn:fluxfarm:problem:"


class FieldProblem(BaseModel):
    """One member of the request that is wrong."""

    field: str
    value: str
    message: str


class Problem(BaseModel):
    """RFC 9457 problem details. `type` ends with one of the error codes in the service's README."""

    type: str
    title: str
    status: int
    detail: str
    instance: str | None = None
    errors: list[FieldProblem] | None = None
    missing: dict[str, str] | None = None


Responses = dict[int | str, dict[str, Any]]


def problem_responses(*statuses: int, also: Responses | None = None) -> Responses:
    """For a route's `responses`: the problem replies that it can give, and `also` what else."""
    return (also or {}) | {
        status: {"model": Problem, "description": HTTPStatus(status).phrase, "content": {MEDIA_TYPE: {}}}
        for status in statuses
    }


def problem(
    status: int,
    code: str,
    detail: str,
    instance: str | None = None,
    extra: dict[str, Any] | None = None,
    headers: dict[str, str] | None = None,
) -> Response:
    """One problem reply."""
    body: dict[str, Any] = {
        "type": TYPE_PREFIX + code,
        "title": code.replace("-", " ").capitalize(),
        "status": status,
        "detail": detail,
    }
    if instance is not None:
        body["instance"] = instance
    # As plain ASCII, since what a client sent may not be writable otherwise.
    return Response(json.dumps(body | (extra or {})), status, headers, MEDIA_TYPE)


def install(app: FastAPI) -> None:
    """Make `app` answer every error with a problem, and say so in its OpenAPI document."""
    app.openapi = partial(_document, app.openapi)  # type: ignore[method-assign]
    app.add_exception_handler(FarmError, _farm_error)
    app.add_exception_handler(RequestValidationError, _malformed)
    app.add_exception_handler(HTTPException, _http_error)
    app.add_exception_handler(Exception, _internal)


def _document(openapi: Callable[[], dict[str, Any]]) -> dict[str, Any]:
    """The framework puts the schema of a reply under the media type of the route, which is not that of problems."""
    document = openapi()
    for route in (route for methods in document["paths"].values() for route in methods.values()):
        for reply in route["responses"].values():
            if MEDIA_TYPE in reply.get("content", {}):
                reply["content"] = {MEDIA_TYPE: {"schema": {"$ref": f"#/components/schemas/{Problem.__name__}"}}}
    return document


async def _farm_error(request: Request, error: Exception) -> Response:
    assert isinstance(error, FarmError)
    if error.status >= 500:
        log.error("request failed", extra={"path": request.url.path, "reason": str(error)})
    return problem(error.status, error.code, str(error), request.url.path, error.extra(), error.headers())


async def _malformed(request: Request, error: Exception) -> Response:
    assert isinstance(error, RequestValidationError)
    found = [_field_problem(raw) for raw in error.errors()[:20]]
    detail = "; ".join(f"{entry['field']} = {entry['value']}: {entry['message']}" for entry in found[:3])
    extra: dict[str, Any] = {"errors": found}
    return problem(BadRequest.status, BadRequest.code, detail, request.url.path, extra)


async def _http_error(request: Request, error: Exception) -> Response:
    assert isinstance(error, HTTPException)
    if error.status_code == HTTPStatus.NOT_FOUND:
        detail = f"{request.url.path}: nothing has this address; the addresses are listed in /openapi.json"
        return problem(NotFound.status, NotFound.code, detail, request.url.path)
    if error.status_code == HTTPStatus.BAD_REQUEST:  # how the framework calls a body that is no text
        detail = "body: cannot be read as text, expected JSON in UTF-8"
        return problem(BadRequest.status, BadRequest.code, detail, request.url.path)
    phrase = HTTPStatus(error.status_code).phrase
    code = phrase.lower().replace(" ", "-")
    detail = str(error.detail)
    if error.status_code == HTTPStatus.METHOD_NOT_ALLOWED:
        allowed = (error.headers or {}).get("Allow", "another method")
        detail = f"{request.method} {request.url.path}: expected {allowed}"
    return problem(error.status_code, code, detail, request.url.path, headers=dict(error.headers or {}))


async def _internal(request: Request, error: Exception) -> Response:
    log.error("unexpected error", exc_info=error, extra={"path": request.url.path})
    detail = "the service met an error that it does not know; its log says more"
    return problem(FarmError.status, FarmError.code, detail, request.url.path)


def _field_problem(raw: dict[str, Any]) -> dict[str, str]:
    """One validation error of pydantic, with the place as the client wrote it."""
    place: Sequence[Any] = raw.get("loc", ())
    if place and place[0] in ("body", "query", "path", "header"):
        place = place[1:]
    field = ""
    for part in place:
        field += f"[{part}]" if isinstance(part, int) else f".{part}" if field else str(part)
    if raw.get("type") == "json_invalid":
        context = raw.get("ctx", {}).get("error", "")
        return {"field": "body", "value": f"byte {field}", "message": f"expected JSON: {context}"}
    message = str(raw.get("msg", "")).removeprefix("Value error, ")
    if raw.get("type") == "missing":
        return {"field": field, "value": "absent", "message": "expected this member"}
    if raw.get("type") == "extra_forbidden":
        message = "unknown member; expected only those of the OpenAPI document"
    return {
        "field": field or "body",
        "value": shortened(raw.get("input")),
        "message": message[:1].lower() + message[1:],
    }
