"""`fluxfarm plan`: the engine's own plan of a scene, without a service."""

import subprocess

from fluxfarm.cli.charting import chart_scene
from fluxfarm.cli.exits import CommandError, Exit
from fluxfarm.cli.request import JobOptions
from fluxfarm.settings import engine_program, from_environment


def plan_scene(scene: str, options: JobOptions, threads: int | None, as_json: bool) -> None:
    """Print what the engine says; its refusal becomes one error."""
    settings = from_environment()
    found = chart_scene(scene, settings)
    given = {
        "--rel-error": options.rel_error,
        "--spp": options.spp,
        "--seconds": options.seconds,
        "--integrator": options.integrator,
        "--size": options.size,
        "--crop": options.crop,
        "--seed": options.seed,
        "--threads": threads,
    }
    words = [word for name, value in given.items() if value is not None for word in (name, str(value))]
    command = [str(engine_program(settings)), "plan", str(found.path), *words]
    done = subprocess.run([*command, "--json"] if as_json else command, stderr=subprocess.PIPE, text=True, check=False)
    if done.returncode != 0:
        said = done.stderr.strip().splitlines() or [f"the engine ended with status {done.returncode}"]
        raise CommandError(Exit.BAD_INPUT, said[-1].removeprefix("error: "))
