"""What can be set, all from FLUXFARM_ variables of the environment. README.md has a line for each."""

import ipaddress
import os
import shutil
import sys
from collections.abc import Mapping
from dataclasses import dataclass, fields
from pathlib import Path

from fluxfarm.errors import BadSetting, EngineMissing

PREFIX = "FLUXFARM_"
# In the data folder, the API key of who runs the service; nobody else can read it.
OWNER_KEY_FILE = "owner.key"
# Of the machine's memory.
MEMORY_FOR_WORKERS = 0.9
_PACKAGE = Path(__file__).resolve().parent


@dataclass(frozen=True, slots=True)
class Settings:
    """Settings of one service; each field is read from FLUXFARM_<NAME> in capitals."""

    data: Path = Path("~/.local/share/fluxfarm")
    host: str = "127.0.0.1"
    port: int = 8460
    engine: str = ""
    scenes: str = ""
    workers: int = 1
    threads: int = 0
    tile_size: int = 64
    lease_seconds: float = 1.0
    stall_seconds: float = 300.0
    max_asset_bytes: int = 4 << 30
    max_pixels: int = 1 << 27
    least_free_bytes: int = 256 << 20
    keep_assets_hours: float = 24.0
    journal: str = "wal"
    sync: str = "full"
    keys: str = "auto"
    backend: str = "local"
    scheduler: str = ""
    certificates: str = ""
    sandbox: str = "wanted"
    worker_memory_bytes: int = 0
    log_level: str = "info"

    @property
    def threads_per_worker(self) -> int:
        """Threads of each engine process: as set, else all cores shared among the processes."""
        return self.threads or max(1, len(os.sched_getaffinity(0)) // self.workers)

    @property
    def certificates_folder(self) -> Path | None:
        """Where ca.pem, node.pem and node.key are."""
        return Path(self.certificates).expanduser() if self.certificates else None

    @property
    def memory_per_worker(self) -> int:
        """Bytes that an engine process may take: as set, else a share of most of this machine's memory."""
        machine = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
        return self.worker_memory_bytes or int(MEMORY_FOR_WORKERS * machine / self.workers)

    @property
    def asks_for_keys(self) -> bool:
        """Whether requests need an API key: as set, else where other machines can reach the service."""
        return self.keys == "on" or (self.keys == "auto" and not self.on_loopback)

    @property
    def reached_at(self) -> str:
        """The host to ask for from this machine; an address of all interfaces is none to ask for."""
        host = {"0.0.0.0": "127.0.0.1", "::": "::1"}.get(self.host, self.host)
        return f"[{host}]" if ":" in host else host

    @property
    def on_loopback(self) -> bool:
        """Whether only this machine can reach the service. A name other than localhost may mean any address."""
        try:
            return ipaddress.ip_address(self.host).is_loopback
        except ValueError:
            return self.host == "localhost"


DEFAULTS = Settings()
BOUNDS: dict[str, tuple[float, float]] = {
    "port": (0, 65535),
    "workers": (1, 256),
    "threads": (0, 1024),
    "tile_size": (8, 256),
    "lease_seconds": (0.01, 60),
    "stall_seconds": (0.1, 86400),
    "max_asset_bytes": (1, 1 << 50),
    "max_pixels": (1, 1 << 32),
    "least_free_bytes": (0, 1 << 50),
    "keep_assets_hours": (0, 1e6),
    "worker_memory_bytes": (0, 1 << 50),
}
CHOICES: dict[str, tuple[str, ...]] = {
    "journal": ("wal", "delete"),
    "sync": ("full", "off"),
    "backend": ("local", "dask"),
    "sandbox": ("wanted", "required"),
    "keys": ("auto", "on", "off"),
    "log_level": ("debug", "info", "warning", "error"),
}


def from_environment(environment: Mapping[str, str] | None = None) -> Settings:
    """Read the settings; raises BadSetting naming the variable, its value and what would be right."""
    environment = os.environ if environment is None else environment
    values: dict[str, object] = {}
    for field in fields(Settings):
        name = PREFIX + field.name.upper()
        text = environment.get(name, "")
        if text:
            values[field.name] = _parsed(name, field.name, text, type(getattr(DEFAULTS, field.name)))
    settings = Settings(**values)  # type: ignore[arg-type]
    data = {name: getattr(settings, name) for name in Settings.__slots__} | {"data": settings.data.expanduser()}
    return Settings(**data)


def _parsed(variable: str, name: str, text: str, kind: type[Path | str | int | float]) -> object:
    """One value from its text, checked against its bounds or choices."""
    if issubclass(kind, Path):
        return Path(text)
    if kind is str:
        if name in CHOICES and text not in CHOICES[name]:
            raise BadSetting(f"{variable} = {text!r}: expected one of {', '.join(CHOICES[name])}")
        return text
    low, high = BOUNDS[name]
    noun = "a whole number" if kind is int else "a number"
    value: int | float | None
    try:
        value = int(text) if kind is int else float(text)
    except ValueError:
        value = None
    if value is None or not low <= value <= high:
        raise BadSetting(f"{variable} = {text!r}: expected {noun} from {low:g} to {high:g}")
    return value


def engine_program(settings: Settings) -> Path:
    """The engine to run: FLUXFARM_ENGINE, else beside this Python, else on the PATH; raises EngineMissing."""
    if settings.engine:
        program = Path(settings.engine)
        if not (program.is_file() and os.access(program, os.X_OK)):
            raise EngineMissing(f"{PREFIX}ENGINE = {settings.engine!r}: expected a program that can be run")
        return program
    beside = Path(sys.executable).parent / "fluxfarm-engine"
    if beside.is_file():
        return beside
    found = shutil.which("fluxfarm-engine")
    if found is None:
        raise EngineMissing(
            f"fluxfarm-engine: found neither in {beside.parent} nor on the PATH; build it with `make build` or set "
            f"{PREFIX}ENGINE to the program"
        )
    return Path(found)


def scenes_folder(settings: Settings) -> Path | None:
    """Folder of the scenes that come with the service: FLUXFARM_SCENES, else the repository's; None if none."""
    if settings.scenes:
        return Path(settings.scenes)
    for folder in (_PACKAGE / "scenes", *(parent / "scenes" for parent in list(_PACKAGE.parents)[:4])):
        if folder.is_dir():
            return folder
    installed = Path(sys.prefix) / "share" / "fluxfarm" / "scenes"
    return installed if installed.is_dir() else None
