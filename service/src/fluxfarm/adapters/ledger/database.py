"""One SQLite file: exactly one writing connection in one thread, readers that can only read.

The writer takes everything that is waiting into one transaction, so that many small changes share one sync to disk.
Because only the writer ever writes or runs checkpoints, SQLite's WAL-reset bug (before 3.51.3) cannot occur.
"""

import asyncio
import logging
import queue
import sqlite3
import threading
from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from pathlib import Path
from typing import Any, TypeVar, cast

from sqlalchemy import Connection, Engine, create_engine, event
from sqlalchemy.pool import QueuePool, StaticPool

from fluxfarm.adapters.ledger.schema import MIGRATIONS
from fluxfarm.errors import FarmError, SchemaTooNew, StoreDamaged, StoreUnusable
from fluxfarm.failpoints import reach

T = TypeVar("T")
log = logging.getLogger(__name__)

# First SQLite without the WAL-reset bug.
GOOD_SQLITE = (3, 51, 3)
READERS = 4
MOST_WORK_IN_ONE_TRANSACTION = 500


class Database:
    """The file at `path`, opened, checked and brought to the newest schema; synced at each commit if `durable`."""

    def __init__(self, path: Path, journal: str, durable: bool) -> None:
        """Raises StoreDamaged, StoreUnusable or SchemaTooNew."""
        self._path = path
        self._journal = journal
        self._synchronous = "FULL" if durable else "OFF"
        self._work: queue.SimpleQueue[tuple[Callable[[Connection], Any], Future[Any]] | None] = queue.SimpleQueue()
        self._writing = self._open_writer()
        migrate(self._writing)
        self._reading = self._open_readers()
        self._readers = ThreadPoolExecutor(READERS, thread_name_prefix="ledger-read")
        self._writer = threading.Thread(target=self._write_all, name="ledger-write", daemon=True)
        self._writer.start()

    def post(self, work: Callable[[Connection], T]) -> "Future[T]":
        """Have `work` done in a transaction, in the order of the calls; it is durable when the future is done."""
        future: Future[T] = Future()
        self._work.put((work, future))
        return future

    async def write(self, work: Callable[[Connection], T]) -> T:
        """Like `post`, and wait."""
        return await asyncio.wrap_future(self.post(work))

    async def read(self, work: Callable[[Connection], T]) -> T:
        """Have `work` done on a connection that can only read."""

        def reading() -> T:
            with self._reading.connect() as connection:
                return work(connection)

        return await asyncio.get_running_loop().run_in_executor(self._readers, reading)

    def close(self) -> None:
        """Finish what is waiting, then close."""
        self._work.put(None)
        self._writer.join()
        self._readers.shutdown()
        self._reading.dispose()
        self._writing.dispose()

    def _open_writer(self) -> Engine:
        def connect() -> sqlite3.Connection:
            try:
                connection = sqlite3.connect(self._path, isolation_level=None, check_same_thread=False)
                connection.execute(f"PRAGMA journal_mode = {self._journal}")
                for pragma in (f"synchronous = {self._synchronous}", "foreign_keys = ON", "busy_timeout = 5000"):
                    connection.execute(f"PRAGMA {pragma}")
                found = connection.execute("PRAGMA quick_check(1)").fetchone()[0]
            except sqlite3.OperationalError as error:  # "database is locked", "attempt to write a readonly database"
                raise StoreUnusable(
                    f"{self._path}: {error}; expected a database that this user can write and no other program holds"
                ) from None
            except sqlite3.DatabaseError as error:
                raise StoreDamaged(
                    f"{self._path}: {error}; expected an SQLite database, restore it from a backup"
                ) from None
            if found != "ok":
                raise StoreDamaged(f"{self._path}: SQLite's quick_check says {found!r}; restore it from a backup")
            return connection

        engine = create_engine("sqlite+pysqlite://", creator=connect, poolclass=StaticPool)
        event.listen(engine, "begin", lambda connection: connection.exec_driver_sql("BEGIN IMMEDIATE"))
        return engine

    def _open_readers(self) -> Engine:
        def connect() -> sqlite3.Connection:
            connection = sqlite3.connect(
                f"{self._path.absolute().as_uri()}?mode=ro", uri=True, isolation_level=None, check_same_thread=False
            )
            connection.execute("PRAGMA wal_autocheckpoint = 0")
            connection.execute("PRAGMA busy_timeout = 5000")
            connection.execute("PRAGMA query_only = ON")
            return connection

        engine = create_engine("sqlite+pysqlite://", creator=connect, poolclass=QueuePool, pool_size=READERS)
        # A reader sees one state of the ledger from its first query to its last.
        event.listen(engine, "begin", lambda connection: connection.exec_driver_sql("BEGIN"))
        return engine

    def _write_all(self) -> None:
        with self._writing.connect() as connection:
            while (first := self._work.get()) is not None:
                batch, last = [first], False
                while len(batch) < MOST_WORK_IN_ONE_TRANSACTION and not self._work.empty():
                    following = self._work.get()
                    if following is None:
                        last = True
                        break
                    batch.append(following)
                self._write_batch(connection, batch)
                if last:
                    return

    def _write_batch(
        self, connection: Connection, batch: list[tuple[Callable[[Connection], Any], Future[Any]]]
    ) -> None:
        """One transaction; work that raises is undone alone, and the error goes to who asked for it."""
        results: list[tuple[Future[Any], Any, BaseException | None]] = []
        try:
            with connection.begin():
                for work, future in batch:
                    try:
                        with connection.begin_nested():
                            results.append((future, work(connection), None))
                    except Exception as error:
                        if not isinstance(error, FarmError):
                            log.exception("a write to the ledger failed")
                        results.append((future, None, error))
                reach("transaction-open")
        except Exception as error:  # the commit itself: nothing of the batch happened
            log.exception("a commit of the ledger failed")
            results = [(future, None, error) for _, future in batch]
        for future, value, fault in results:
            if not future.set_running_or_notify_cancel():
                continue
            if fault is None:
                future.set_result(value)
            else:
                future.set_exception(fault)


def migrate(engine: Engine) -> None:
    """Bring the schema up to the last migration; raises SchemaTooNew if it is beyond it."""
    with engine.connect() as connection, connection.begin():
        connection.exec_driver_sql("CREATE TABLE IF NOT EXISTS schema_version (version INTEGER NOT NULL) STRICT")
        version = cast(int, connection.exec_driver_sql("SELECT max(version) FROM schema_version").scalar() or 0)
        if version > len(MIGRATIONS):
            raise SchemaTooNew(
                f"the ledger has schema {version}, this service knows {len(MIGRATIONS)}: run the newer service on it"
            )
        for number, script in enumerate(MIGRATIONS[version:], version + 1):
            for statement in script.split(";"):
                if statement.strip():
                    connection.exec_driver_sql(statement)
            connection.exec_driver_sql("INSERT INTO schema_version (version) VALUES (?)", (number,))


def sqlite_warning() -> str | None:
    """A sentence if this Python's SQLite has the WAL-reset bug, else None."""
    if sqlite3.sqlite_version_info >= GOOD_SQLITE:
        return None
    return (
        f"SQLite {sqlite3.sqlite_version} is older than 3.51.3 and has the WAL-reset bug; this service cannot meet it "
        "because one connection does all writing, but other programs must not write the database"
    )
