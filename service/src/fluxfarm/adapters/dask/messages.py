"""What service and workers say to each other through Dask."""

from dataclasses import dataclass

from fluxfarm.domain.leases import FailureKind


@dataclass(frozen=True, slots=True)
class Greeting:
    """What a worker is, told whenever it is asked. `state` is that of its engine process, "" before there is one."""

    version: str
    host: str
    state: str
    pid: int | None
    threads: int
    engine_build: str
    restarts: int
    last_words: str
    sandbox_missing: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class RenderedTile:
    """The sums of one tile, as the engine wrote them; `sha256` is that of `content`."""

    position: int
    content: bytes
    sha256: str
    seconds: float
    rays: int
    non_finite_samples: int


@dataclass(frozen=True, slots=True)
class Rendered:
    """What became of a lease: its tiles, and why not all of them are there. `missing` are files of the scene that the
    worker lacks: then it has not begun."""

    tiles: tuple[RenderedTile, ...] = ()
    missing: tuple[str, ...] = ()
    failure: tuple[FailureKind, str] | None = None
    lost: tuple[str, bool] | None = None  # as in LeaseLost
