"""The JSON that goes in and out. Unknown members are errors, numbers are not guessed from text."""

from datetime import UTC, datetime
from typing import Annotated, Any, Literal

from pydantic import AfterValidator, BaseModel, ConfigDict, Field, model_validator

from fluxfarm.domain.goal import settled
from fluxfarm.domain.job import JobState
from fluxfarm.domain.progress import Progress
from fluxfarm.domain.records import JobRecord, Revision
from fluxfarm.domain.scene import SHA256_PATTERN

MAX_SIDE = 65_536
MAX_SPP = 1 << 24
MAX_SECONDS = 30 * 86_400
MAX_SEED = (1 << 53) - 1


def _printable(name: str) -> str:
    if any(ord(character) < 32 or 0xD800 <= ord(character) < 0xE000 for character in name):
        raise ValueError("expected text without control characters")
    return name


# For people.
Name = Annotated[str, AfterValidator(_printable), Field(max_length=200)]
Integrator = Literal["auto", "path", "photon", "photon-progressive", "irradiance-cache"]


class Strict(BaseModel):
    """Base of what goes in."""

    model_config = ConfigDict(extra="forbid", strict=True, allow_inf_nan=False)


class SceneIn(Strict):
    """Either a bundle (`entry` and `files`) or a scene that comes with the service (`builtin`)."""

    entry: str | None = Field(
        default=None, description="The scene file, one of the paths in `files`.", examples=["scene.xml"]
    )
    files: dict[str, str] | None = Field(
        default=None, description="Every file of the scene: path inside the bundle -> SHA-256 of an uploaded asset."
    )
    builtin: str | None = Field(
        default=None, description="Name of a scene that comes with the service.", examples=["cornell"]
    )

    @model_validator(mode="after")
    def _either(self) -> "SceneIn":
        bundle = self.entry is not None and self.files is not None
        if (self.builtin is None) != bundle or (self.builtin and (self.entry or self.files)):
            raise ValueError("expected either `entry` with `files`, or `builtin`")
        return self


class SizeIn(Strict):
    """Frame size in pixels, instead of the scene's own."""

    width: int = Field(ge=1, le=MAX_SIDE)
    height: int = Field(ge=1, le=MAX_SIDE)


class CropIn(Strict):
    """The part of the frame to render, in pixels, origin top left."""

    x: int = Field(ge=0, lt=MAX_SIDE)
    y: int = Field(ge=0, lt=MAX_SIDE)
    width: int = Field(ge=1, le=MAX_SIDE)
    height: int = Field(ge=1, le=MAX_SIDE)


class GoalIn(Strict):
    """What to reach: exactly one of the three."""

    rel_error: float | None = Field(
        default=None, gt=0, le=10, description="Relative error sqrt(relMSE), estimated from the noise.", examples=[0.05]
    )
    spp: int | None = Field(default=None, ge=1, le=MAX_SPP, description="Samples per pixel.", examples=[256])
    seconds: float | None = Field(default=None, gt=0, le=MAX_SECONDS, description="Time in RUNNING, in seconds.")

    @model_validator(mode="after")
    def _exactly_one(self) -> "GoalIn":
        if [self.rel_error, self.spp, self.seconds].count(None) != 2:
            raise ValueError("expected exactly one of `rel_error`, `spp` and `seconds`")
        return self


class LimitsIn(Strict):
    """Bounds that end a job before its goal, with a warning."""

    spp: int | None = Field(default=None, ge=1, le=MAX_SPP, description="Most samples per pixel.")
    seconds: float | None = Field(default=None, gt=0, le=MAX_SECONDS, description="Most time in RUNNING, in seconds.")


class JobIn(Strict):
    """A scene and what is wanted of it."""

    name: Name = Field("", description="For people; the service does not read it.")
    scene: SceneIn
    size: SizeIn | None = None
    crop: CropIn | None = None
    integrator: Integrator | None = Field(
        default=None,
        description="Method; `auto`: the one that takes the least work; absent: the scene's own, of glTF `auto`.",
    )
    goal: GoalIn | None = Field(
        default=None, description="Absent: the scene's own sample count, else 64 samples per pixel."
    )
    limits: LimitsIn = Field(default_factory=LimitsIn)
    priority: int = Field(0, ge=-100, le=100, description="Higher goes first.")
    seed: int = Field(0, ge=0, le=MAX_SEED, description="Another seed gives an independent image.")


class MissingIn(Strict):
    """Digests to look for."""

    sha256: list[Annotated[str, Field(pattern=SHA256_PATTERN)]] = Field(max_length=10_000)


class MissingOut(BaseModel):
    """Those that have to be uploaded."""

    missing: list[str]


class AssetOut(BaseModel):
    """An asset that is stored now."""

    sha256: str


class ProgressOut(BaseModel):
    """How far the job is. Totals are 0 while they are not known; `pass` counts from 1."""

    model_config = ConfigDict(populate_by_name=True)

    tiles_done: int
    tiles_total: int
    samples_done: int = Field(description="Camera samples, over all pixels.")
    pass_number: int = Field(alias="pass")
    error_now: float | None = Field(description="Estimated relative error of the newest revision.")
    eta_seconds: float | None


class RevisionOut(BaseModel):
    """A published image."""

    revision: int
    samples: int = Field(description="Samples per pixel, the fewest of any pixel.")
    error_noise: float | None
    error_bias: float | None = Field(description="Estimated relative error by the method's own bias; 0: it has none.")
    seconds: float = Field(description="Time in RUNNING when it was published.")
    sha256: str
    bytes: int
    non_finite_samples: int


class JobOut(BaseModel):
    """A job as it is now."""

    id: str
    name: str
    state: JobState
    reason: str | None = Field(description="Why the job failed, or waits without its owner's wish.")
    created_at: str
    owner: str | None = Field(description="Id of the API key that submitted it; absent where none are asked for.")
    scene: dict[str, Any]
    size: dict[str, int] | None
    crop: dict[str, int] | None
    integrator: str | None
    goal: dict[str, int | float] | None
    limits: dict[str, float]
    priority: int
    seed: int
    progress: ProgressOut
    revision: int | None = Field(description="Number of the newest revision.")
    plan: dict[str, Any] | None = Field(description="What the scene contains and which parts of the engine are on.")
    warnings: list[str]


class JobsOut(BaseModel):
    """Jobs, newest first."""

    jobs: list[JobOut]


class RevisionsOut(BaseModel):
    """All revisions of a job, oldest first."""

    revisions: list[RevisionOut]


def job_out(record: JobRecord, progress: Progress) -> JobOut:
    """A job as JSON."""
    request, facts = record.request, record.facts
    scene: dict[str, Any] = {"entry": request.bundle.entry, "files": request.bundle.files}
    if request.builtin is not None:
        scene = {"builtin": request.builtin}
    size = (facts.width, facts.height) if facts is not None else request.size
    goal = request.goal if facts is None else settled(request.goal, facts.scene_spp)
    crop = record.grid.crop if record.grid is not None else request.crop
    return JobOut(
        id=record.id,
        name=request.name,
        state=record.state,
        reason=record.reason,
        created_at=iso_time(record.created_at),
        owner=record.owner,
        scene=scene | {"digest": request.bundle.digest()},
        size=None if size is None else {"width": size[0], "height": size[1]},
        crop=None if crop is None else {"x": crop.x, "y": crop.y, "width": crop.width, "height": crop.height},
        integrator=request.integrator if facts is None else facts.integrator,
        goal=_present(goal.rel_error, goal.spp, goal.seconds) or None,
        limits=_present(None, request.limits.spp, request.limits.seconds),
        priority=request.priority,
        seed=request.seed,
        progress=ProgressOut.model_validate(
            {
                "tiles_done": progress.tiles_done,
                "tiles_total": progress.tiles_total,
                "samples_done": progress.samples_done,
                "pass": progress.pass_number,
                "error_now": progress.error_now,
                "eta_seconds": None if progress.eta_seconds is None else round(progress.eta_seconds, 3),
            }
        ),
        revision=None if record.newest is None else record.newest.number,
        plan=None if facts is None else facts.plan,
        warnings=list(record.warnings),
    )


def revision_out(revision: Revision) -> RevisionOut:
    """A revision as JSON."""
    return RevisionOut(
        revision=revision.number,
        samples=revision.min_samples,
        error_noise=revision.error_noise,
        error_bias=revision.error_bias,
        seconds=round(revision.running_s, 6),
        sha256=revision.exr,
        bytes=revision.exr_bytes,
        non_finite_samples=revision.non_finite_samples,
    )


def iso_time(unix_s: float) -> str:
    """Unix time in seconds as ISO 8601 in UTC."""
    return datetime.fromtimestamp(unix_s, UTC).isoformat(timespec="milliseconds").replace("+00:00", "Z")


def _present(rel_error: float | None, spp: int | None, seconds: float | None) -> dict[str, int | float]:
    named = {"rel_error": rel_error, "spp": spp, "seconds": seconds}
    return {name: value for name, value in named.items() if value is not None}
