"""From options of the command line to the JSON of a job."""

import re
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from fluxfarm.cli.bundle import LocalBundle, collect
from fluxfarm.cli.client import ServiceClient
from fluxfarm.cli.exits import CommandError, Exit


@dataclass(frozen=True, slots=True)
class JobOptions:
    """What `render` and `submit` take beside the scene. `size` is WIDTHxHEIGHT, `crop` X,Y,WIDTH,HEIGHT."""

    rel_error: float | None = None
    spp: int | None = None
    seconds: float | None = None
    integrator: str | None = None
    size: str | None = None
    crop: str | None = None
    seed: int = 0
    priority: int = 0
    name: str | None = None


def find_scene(scene: str) -> LocalBundle | str:
    """The bundle of a scene file, or the name of a scene that comes with the service."""
    path = Path(scene)
    if path.is_dir() and (path / "scene.xml").is_file():
        path = path / "scene.xml"
    if path.is_file():
        return collect(path)
    if re.fullmatch(r"[\w-]+", scene):
        return scene
    raise CommandError(Exit.BAD_INPUT, f"{scene}: there is no such file; expected a scene file or a built-in name")


def job_body(client: ServiceClient, scene: LocalBundle | str, options: JobOptions) -> dict[str, Any]:
    """The body of POST /v1/jobs; uploads the scene's files."""
    body = option_members(options)
    if isinstance(scene, str):
        return body | {"scene": {"builtin": scene}, "name": options.name or scene}
    files = client.upload(scene)
    return body | {"scene": {"entry": scene.entry, "files": files}, "name": options.name or Path(scene.entry).stem}


def option_members(options: JobOptions) -> dict[str, Any]:
    """Members of the body that come from the options alone; raises CommandError for options that mean nothing."""
    goals = {"rel_error": options.rel_error, "spp": options.spp, "seconds": options.seconds}
    goal = {name: value for name, value in goals.items() if value is not None}
    if len(goal) > 1:
        raise CommandError(Exit.BAD_INPUT, "expected at most one of --rel-error, --spp and --seconds")
    body: dict[str, Any] = {"seed": options.seed, "priority": options.priority}
    if goal:
        body["goal"] = goal
    if options.integrator:
        body["integrator"] = options.integrator
    if options.size:
        width, height = parse_size(options.size)
        body["size"] = {"width": width, "height": height}
    if options.crop:
        x, y, width, height = _whole_numbers("--crop", options.crop, ",", ("X", "Y", "WIDTH", "HEIGHT"))
        body["crop"] = {"x": x, "y": y, "width": width, "height": height}
    return body


def parse_size(text: str) -> tuple[int, int]:
    """Width and height in pixels of a --size."""
    width, height = _whole_numbers("--size", text, "x", ("WIDTH", "HEIGHT"))
    return width, height


def _whole_numbers(option: str, text: str, separator: str, names: tuple[str, ...]) -> list[int]:
    parts = text.split(separator)
    if len(parts) != len(names) or not all(part.isascii() and part.isdigit() for part in parts):
        raise CommandError(Exit.BAD_INPUT, f"{option} = {text!r}: expected {separator.join(names)} in pixels")
    return [int(part) for part in parts]
