"""Work for engine processes, complete in itself, and what comes back from it."""

from dataclasses import dataclass, replace
from enum import StrEnum
from pathlib import Path

from fluxfarm.domain.goal import Goal
from fluxfarm.domain.records import SceneFacts
from fluxfarm.domain.scene import SceneBundle
from fluxfarm.domain.schedule import Round, SampleRange
from fluxfarm.domain.tiles import PixelRect


@dataclass(frozen=True, slots=True)
class Picture:
    """What a method is chosen for. `crop` None: as the scene says; the same for a goal with nothing set."""

    crop: PixelRect | None
    seed: int
    goal: Goal


@dataclass(frozen=True, slots=True)
class SceneRef:
    """A scene for an engine process: `entry` in `folder`, with the files of `bundle`. Zeros and "": as the scene says.

    `key` differs whenever anything below differs, with one exception: the integrator "auto" for a picture has the key
    of the method that is chosen for it."""

    key: str
    folder: Path
    entry: str
    width: int
    height: int
    integrator: str
    bundle: SceneBundle
    picture: Picture | None = None

    def with_method(self, chosen: str) -> "SceneRef":
        """The same once a method was chosen for its picture; of a scene with a method, the scene itself."""
        return self if self.picture is None else replace(self, integrator=chosen, picture=None)


@dataclass(frozen=True, slots=True)
class ImageInfo:
    """Goes into the header of an image."""

    job_id: str
    scene_digest: str
    integrator: str
    seed: int


@dataclass(frozen=True, slots=True)
class Lease:
    """Work for one engine process, complete in itself. `fence` is unique and rises; a revoked fence commits nothing."""

    fence: int
    job_id: str


@dataclass(frozen=True, slots=True)
class PrepareLease(Lease):
    """Read and compile the scene."""

    scene: SceneRef


@dataclass(frozen=True, slots=True)
class RenderLease(Lease):
    """Take `samples` of every pixel of `rects`; `tiles` are the grid's indices of the same tiles. The paths of the
    scratch files that take their sums begin with `tiles_out`."""

    scene: SceneRef
    seed: int
    pass_index: int
    samples: SampleRange
    tiles: tuple[int, ...]
    rects: tuple[PixelRect, ...]
    tiles_out: Path

    def file(self, position: int) -> Path:
        """Where the engine process writes the sums of the tile at `position`."""
        return self.tiles_out.with_name(f"{self.tiles_out.name}-{position}.tile")


@dataclass(frozen=True, slots=True)
class Decision:
    """What an engine process needs to decide an error goal after the round `round`; it audits `scene`."""

    rel_error: float
    round: int
    most_samples: int
    scene: SceneRef


@dataclass(frozen=True, slots=True)
class MergeLease(Lease):
    """Add finished tiles to the film and write the image, its preview and, where a path is given, the film."""

    width: int
    height: int
    crop: PixelRect
    film_in: Path | None
    tiles: tuple[Path, ...]
    film_out: Path | None
    exr_out: Path
    png_out: Path
    info: ImageInfo
    passes: int
    decision: Decision | None


@dataclass(frozen=True, slots=True)
class WriteTileLease(Lease):
    """Write one rect of the film, with tiles that are not in it yet, as an image of its own."""

    width: int
    height: int
    rect: PixelRect
    film_in: Path | None
    tiles: tuple[Path, ...]
    exr_out: Path
    info: ImageInfo


class FailureKind(StrEnum):
    """Why an engine process refused: only RESOURCE is worth another try elsewhere or later."""

    SCENE = "SCENE"
    RESOURCE = "RESOURCE"
    INTERNAL = "INTERNAL"
    CANCELLED = "CANCELLED"


@dataclass(frozen=True, slots=True)
class Prepared:
    """The scene is compiled."""

    lease: PrepareLease
    facts: SceneFacts


@dataclass(frozen=True, slots=True)
class SamplesTaken:
    """`samples` camera samples of the lease are finished so far."""

    lease: RenderLease
    samples: int


@dataclass(frozen=True, slots=True)
class TileRendered:
    """The file of the tile at `position` of the lease is written and closed, but not yet synced; it has `size` bytes.
    `seconds` on one thread."""

    lease: RenderLease
    position: int
    size: int
    seconds: float
    rays: int
    non_finite_samples: int


@dataclass(frozen=True, slots=True)
class TilesFinished:
    """Every tile of the lease was reported."""

    lease: RenderLease


@dataclass(frozen=True, slots=True)
class Merged:
    """The files of the lease are written and closed, but not yet synced. The last five: as in Revision."""

    lease: MergeLease
    min_samples: int
    max_samples: int
    mean_samples: float
    error_noise: float | None
    error_bias: float | None
    mean: tuple[float, float, float]
    non_finite_samples: int
    seconds: float
    error_bound: float | None
    next_round: Round | None
    samples_expected: float | None
    error_unseen: float | None
    unseen_warning: str | None


@dataclass(frozen=True, slots=True)
class TileWritten:
    """The image of the tile is written."""

    lease: WriteTileLease


@dataclass(frozen=True, slots=True)
class LeaseFailed:
    """The engine process refused the lease and lives on."""

    lease: Lease
    kind: FailureKind
    message: str


@dataclass(frozen=True, slots=True)
class LeaseLost:
    """The engine process died or was stopped; `blamed` if it was working on this lease when it died."""

    lease: Lease
    reason: str
    blamed: bool


Outcome = Prepared | SamplesTaken | TileRendered | TilesFinished | Merged | TileWritten | LeaseFailed | LeaseLost
