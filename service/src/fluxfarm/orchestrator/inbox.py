"""One queue of work, handled one piece after the other by one task."""

import asyncio
from collections.abc import Awaitable, Callable
from typing import TypeVar

T = TypeVar("T")
Work = Callable[[], Awaitable[None]]


class Inbox:
    """Put work in from anywhere in the event loop; `next` gives it out in order."""

    def __init__(self) -> None:
        self._queue: asyncio.Queue[Work] = asyncio.Queue()

    def put(self, work: Work) -> None:
        """Have `work` done without waiting for it."""
        self._queue.put_nowait(work)

    def wake(self) -> None:
        """Have nothing done, so that whoever handles the queue looks around."""

        async def nothing() -> None:
            return None

        self._queue.put_nowait(nothing)

    async def ask(self, work: Callable[[], Awaitable[T]]) -> T:
        """Have `work` done and return its result, or raise what it raises."""
        answer: asyncio.Future[T] = asyncio.get_running_loop().create_future()

        async def asked() -> None:
            try:
                result = await work()
            except Exception as error:
                if not answer.done():
                    answer.set_exception(error)
            else:
                if not answer.done():
                    answer.set_result(result)

        self._queue.put_nowait(asked)
        return await answer

    async def next(self) -> Work:
        """The next piece of work, waiting for it."""
        return await self._queue.get()

    @property
    def empty(self) -> bool:
        """Whether nothing waits."""
        return self._queue.empty()
