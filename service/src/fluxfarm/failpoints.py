"""Places between two effects that belong together, at which a test has the service killed.

FLUXFARM_FAILPOINT=NAME or NAME:N kills this process, as `kill -9` would, when NAME is reached (for the Nth time).
Without the variable a failpoint does nothing.
"""

import itertools
import os
import signal

FAILPOINTS: dict[str, str] = {
    "asset-synced": "An upload is on disk, but not under its digest.",
    "asset-kept": "It is under its digest, and nobody was told.",
    "job-recorded": "A job is in the ledger, and nobody was told.",
    "facts-recorded": "A prepared scene is in the ledger, and its job RUNNING there alone.",
    "tile-synced": "A tile is on disk, but not under its digest.",
    "tile-renamed": "It is under its digest, in a folder that is not synced.",
    "tiles-stored": "A batch of tiles is stored, and not in the ledger.",
    "transaction-open": "Changes were made in a transaction that is not committed.",
    "tiles-committed": "A batch is in the ledger, and nobody was told.",
    "output-synced": "An image or a film is on disk, but not under its digest.",
    "output-kept": "It is under its digest, and not in the ledger.",
    "revision-recorded": "A revision is in the ledger, and what it replaces still on disk.",
    "revision-cleared": "What it replaces is gone, and nobody was told.",
    "finalizing": "A job is FINALIZING in the ledger, and nobody was told.",
    "succeeded": "A job is SUCCEEDED in the ledger, and nobody was told.",
}

_name, _, _count = os.environ.get("FLUXFARM_FAILPOINT", "").partition(":")
_times = itertools.count(1)


def reach(name: str) -> None:
    """End this process if it is told to end here."""
    if name == _name and next(_times) == int(_count or 1):
        os.kill(os.getpid(), signal.SIGKILL)
