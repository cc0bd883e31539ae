"""Looks at JSON bodies before anything parses them: their length and their depth.

A pure ASGI middleware; uploads of assets pass through untouched, since their route streams and measures them itself.
"""

import re
from collections.abc import Awaitable, Callable, MutableMapping
from typing import Any

from fluxfarm.api.problems import problem
from fluxfarm.errors import BadRequest, TooLarge

Message = MutableMapping[str, Any]
Receive = Callable[[], Awaitable[Message]]
Send = Callable[[Message], Awaitable[None]]
App = Callable[[Message, Receive, Send], Awaitable[None]]

MAX_BODY_BYTES = 4 << 20
MAX_DRAINED_BYTES = 64 << 20
MAX_DEPTH = 64
_STRING = re.compile(rb'"(?:[^"\\]|\\.)*+"', re.DOTALL)
_BRACKET = re.compile(rb"[\[\]{}]")


class BodyGuard:
    """Refuses bodies over MAX_BODY_BYTES with 413 and nesting over MAX_DEPTH with 422."""

    def __init__(self, app: App) -> None:
        self._app = app

    async def __call__(self, scope: Message, receive: Receive, send: Send) -> None:
        """Handle one request."""
        if scope["type"] != "http" or scope["method"] != "POST":
            await self._app(scope, receive, send)
            return
        body, length, disconnected = bytearray(), 0, False
        while True:
            message = await receive()
            if message["type"] == "http.disconnect":
                disconnected = True
                break
            length += len(message.get("body", b""))
            if length <= MAX_BODY_BYTES:
                body += message.get("body", b"")
            # A client reads the reply only when it has sent its body, so some of what is too much is read too.
            if length > MAX_DRAINED_BYTES or not message.get("more_body", False):
                break
        reply = None
        if length > MAX_BODY_BYTES:
            detail = f"body: longer than {MAX_BODY_BYTES} bytes, the most that is taken; upload files as assets"
            reply = problem(TooLarge.status, TooLarge.code, detail, scope["path"], headers={"Connection": "close"})
        elif (place := too_deep(bytes(body))) is not None:
            detail = f"body: nested deeper than {MAX_DEPTH} levels at byte {place}, expected a flat job"
            reply = problem(BadRequest.status, BadRequest.code, detail, scope["path"])
        if reply is not None:
            await reply(scope, receive, send)
            return
        sent = False

        async def replay() -> Message:
            nonlocal sent
            if disconnected:
                return {"type": "http.disconnect"}
            if sent:
                return await receive()
            sent = True
            return {"type": "http.request", "body": bytes(body), "more_body": False}

        await self._app(scope, replay, send)


def too_deep(body: bytes) -> int | None:
    """The byte at which JSON nests deeper than MAX_DEPTH, or None; brackets inside strings do not count."""
    if body.count(b"[") + body.count(b"{") <= MAX_DEPTH:
        return None
    blanked = _STRING.sub(lambda match: b" " * len(match[0]), body)
    depth = 0
    for bracket in _BRACKET.finditer(blanked):
        depth += 1 if bracket[0] in b"[{" else -1
        if depth > MAX_DEPTH:
            return bracket.start()
    return None
