"""Waking those who wait for a job to change.

A reader takes a ticket, reads the ledger, and waits on the ticket if there was nothing new: a change between the two
has spent the ticket already, so nothing is missed. Readers pull, so a slow one costs nothing.
"""

import asyncio


class Watch:
    """Tickets by job."""

    def __init__(self) -> None:
        self._tickets: dict[str, asyncio.Event] = {}
        self.closed = False

    def ticket(self, job_id: str) -> asyncio.Event:
        """An event that is set at the job's next change."""
        ticket = self._tickets.get(job_id)
        if ticket is None:
            ticket = self._tickets[job_id] = asyncio.Event()
            if self.closed:
                ticket.set()
        return ticket

    def notify(self, job_id: str) -> None:
        """The job changed."""
        ticket = self._tickets.pop(job_id, None)
        if ticket is not None:
            ticket.set()

    def close(self) -> None:
        """The service ends: wake everybody."""
        self.closed = True
        for job_id in list(self._tickets):
            self.notify(job_id)
