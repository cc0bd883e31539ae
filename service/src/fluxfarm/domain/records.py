"""Jobs and what belongs to them, as the ledger keeps them."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from fluxfarm.domain.goal import Goal, Limits
from fluxfarm.domain.job import JobState
from fluxfarm.domain.scene import SceneBundle
from fluxfarm.domain.schedule import Round, SampleRange
from fluxfarm.domain.tiles import PixelRect, TileGrid

# The integrator that a pilot chooses.
AUTO = "auto"


@dataclass(frozen=True, slots=True)
class JobRequest:
    """A checked request: what the owner asked for. `size` (width, height) and `crop` are in pixels."""

    name: str
    bundle: SceneBundle
    builtin: str | None
    size: tuple[int, int] | None
    crop: PixelRect | None
    integrator: str | None
    goal: Goal
    limits: Limits
    priority: int
    seed: int

    @property
    def samples(self) -> int:
        """Camera samples that the job is known to take; 0 if goal or size do not tell."""
        if self.goal.spp is None or self.size is None:
            return 0
        pixels = self.size[0] * self.size[1] if self.crop is None else self.crop.area
        return self.goal.spp * pixels

    @property
    def method(self) -> str:
        """The integrator to render with; "" is the scene's own. A glTF file has no word for one, so it gets AUTO."""
        is_gltf = self.bundle.entry.lower().endswith((".glb", ".gltf"))
        return self.integrator or (AUTO if is_gltf else "")


@dataclass(frozen=True, slots=True)
class SceneFacts:
    """What the engine found in the scene. `scene_spp` is 0 when the file does not say."""

    width: int
    height: int
    crop: PixelRect
    scene_spp: int
    integrator: str
    warnings: tuple[str, ...]
    plan: dict[str, Any]
    seconds: float


@dataclass(frozen=True, slots=True)
class Revision:
    """A published image. Digests name files of the job; `film` is None where none was written, or a newer one is.

    `error_bias` is that of the method: 0 where it has none, None where too few samples tell of it.
    Where an error goal was decided, `error_bound` is the bound that may end the job, `next_round` what follows (None:
    no tile may take more samples, or the goal is reached) and `samples_expected` the camera samples of the whole job.
    `error_unseen` is the part of the bound by light that paths did not find (None: not audited), and `unseen_warning`
    says why the job ends without its goal, if that is the reason, or that the claim rests on noise alone.
    """

    number: int
    passes: int
    min_samples: int
    max_samples: int
    mean_samples: float
    error_noise: float | None
    error_bias: float | None
    mean: tuple[float, float, float]
    non_finite_samples: int
    running_s: float
    exr: str
    exr_bytes: int
    png: str
    film: str | None
    at: float
    error_bound: float | None = None
    next_round: Round | None = None
    samples_expected: float | None = None
    error_unseen: float | None = None
    unseen_warning: str | None = None


@dataclass(frozen=True, slots=True)
class JobRecord:
    """A job as the ledger knows it. `facts` and `grid` are None before the scene was prepared. `owner` is the id of the
    key that submitted it; None: nobody was asked for one."""

    id: str
    state: JobState
    reason: str | None
    request: JobRequest
    created_at: float
    facts: SceneFacts | None
    grid: TileGrid | None
    warnings: tuple[str, ...]
    tiles_done: int
    samples_done: int
    rays: int
    non_finite_samples: int
    passes_opened: int
    running_s: float
    crashes: int
    resource_failures: int
    newest: Revision | None
    owner: str | None = None


@dataclass(frozen=True, slots=True)
class StoredTile:
    """A committed tile of a pass that no film contains yet."""

    pass_index: int
    tile: int
    sha256: str


@dataclass(frozen=True, slots=True)
class OpenedPass:
    """A pass of some tiles (None: all)."""

    index: int
    samples: SampleRange
    tiles: tuple[int, ...] | None


@dataclass(frozen=True, slots=True)
class Unmerged:
    """What a restart needs of a job: the newest revision that decided an error goal, the samples per pixel that its
    round has come to (None: it has not begun), passes that no revision contains, the newest film and the tiles that it
    does not contain, in the order of their passes."""

    decision: Revision | None
    round_spp: int | None
    passes: tuple[OpenedPass, ...]
    film: str | None
    tiles: tuple[StoredTile, ...]


@dataclass(frozen=True, slots=True)
class TileFile:
    """A tile that an engine process wrote as a scratch file of a job, `size` bytes long as it says."""

    job_id: str
    path: Path
    size: int


@dataclass(frozen=True, slots=True)
class TileCommit:
    """A stored tile that asks to be counted."""

    fence: int
    job_id: str
    pass_index: int
    tile: int
    column: int
    row: int
    rect: PixelRect
    samples: int
    sha256: str
    seconds: float
    rays: int
    non_finite_samples: int
