"""The ledger in SQLite."""

from fluxfarm.adapters.ledger.ledger import SqliteLedger

__all__ = ["SqliteLedger"]
