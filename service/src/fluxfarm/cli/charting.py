"""From the options of `fluxfarm chart` to the measurements."""

import os
import shlex
from importlib.util import find_spec
from pathlib import Path

from fluxfarm.chart.options import ChartOptions, check
from fluxfarm.chart.scenes import ChartScene
from fluxfarm.cli.bundle import collect
from fluxfarm.cli.exits import CommandError, Exit
from fluxfarm.cli.request import find_scene, parse_size
from fluxfarm.peers import PYTHONS
from fluxfarm.settings import Settings, engine_program, from_environment, scenes_folder

PACKAGES = {"numpy": "numpy", "OpenEXR": "OpenEXR", "flip_evaluator": "flip-evaluator", "resvg_py": "resvg_py"}


def chart_scenes(
    scenes: list[str],
    integrators: str,
    peers: str,
    seconds: float,
    seeds: int,
    size: str | None,
    reference: Path | None,
    reference_spp: int,
    out: Path,
) -> None:
    """Check the options, then measure and write all files."""
    missing = [package for module, package in PACKAGES.items() if find_spec(module) is None]
    if missing:
        need = f"`fluxfarm chart` needs {', '.join(missing)}: install the extra fluxfarm[chart]"
        raise CommandError(Exit.UNREACHABLE, need)
    settings = from_environment()
    found = [chart_scene(scene, settings) for scene in scenes]
    options = ChartOptions(
        integrators=names(integrators),
        peers={peer: os.environ.get(PYTHONS.get(peer, "")) for peer in names(peers)},
        seconds=seconds,
        seeds=seeds,
        size=None if size is None else parse_size(size),
        reference=reference,
        reference_spp=reference_spp,
        out=out,
    )
    check(options, [scene.name for scene in found])
    from fluxfarm.chart.command import run

    run(found, engine_program(settings), options, command_line(found, options))


def command_line(scenes: list[ChartScene], options: ChartOptions) -> str:
    """The command in short, with the names of the scenes for their files."""
    words = ["fluxfarm", "chart", *(scene.name for scene in scenes), "--integrators", ",".join(options.integrators)]
    if options.peers:
        words += ["--peers", ",".join(options.peers)]
    words += ["--seconds", f"{options.seconds:g}", "--seeds", str(options.seeds)]
    if options.size is not None:
        words += ["--size", f"{options.size[0]}x{options.size[1]}"]
    if options.reference is None:
        words += ["--reference-spp", str(options.reference_spp)]
    else:
        words += ["--reference", options.reference.name]
    return shlex.join(words)


def names(text: str) -> tuple[str, ...]:
    """What stands between commas, each once, in order."""
    return tuple(dict.fromkeys(part.strip() for part in text.split(",") if part.strip()))


def chart_scene(scene: str, settings: Settings) -> ChartScene:
    """A scene file, or a built-in scene by its name, with all files that it needs."""
    bundle = find_scene(scene)
    if isinstance(bundle, str):
        folder = scenes_folder(settings)
        path = Path() if folder is None else folder / bundle / "scene.xml"
        if not path.is_file():
            raise CommandError(Exit.BAD_INPUT, f"{scene}: expected a scene file or a built-in name")
        bundle, entry = collect(path), path.resolve()
    else:
        entry = bundle.files[bundle.entry]
    name = entry.parent.name if entry.stem == "scene" else entry.stem
    return ChartScene(name, bundle.entry, bundle.files)
