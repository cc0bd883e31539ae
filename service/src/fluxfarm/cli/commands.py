"""The commands and their options. Everything slow to load is imported by the command that needs it."""

import json
import os
import sys
import uuid
from contextlib import suppress
from pathlib import Path
from typing import Annotated, Any

import typer

from fluxfarm.cli.connect import changed, connect, loading, service
from fluxfarm.cli.exits import EXIT_SENTENCES, CommandError, Exit
from fluxfarm.cli.key_commands import keys_app
from fluxfarm.cli.options import (
    CertificatesOption,
    CropOption,
    IntegratorOption,
    JobArgument,
    OutOption,
    PngOption,
    PriorityOption,
    RelErrorOption,
    SceneArgument,
    SchedulerOption,
    SecondsOption,
    SeedOption,
    ServerOption,
    SizeOption,
    SppOption,
)
from fluxfarm.cli.request import JobOptions, find_scene, job_body, option_members
from fluxfarm.errors import FarmError, StartError
from fluxfarm.settings import from_environment

EXITS = "Exit codes: " + "; ".join(f"{code.value} {text}" for code, text in EXIT_SENTENCES.items()) + "."
app = typer.Typer(
    help=f"Render scenes, alone or with a Fluxfarm service.\n\n{EXITS}",
    add_completion=False,
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
)
app.add_typer(keys_app, name="keys")


def main() -> None:
    """Run the command line; every error becomes a message and an exit code."""
    try:
        app()
    except CommandError as error:
        code, message = error.code, str(error)
    except StartError as error:
        code, message = Exit.UNREACHABLE, str(error)
    except FarmError as error:
        code, message = Exit.BAD_INPUT, str(error)
    except KeyboardInterrupt:
        code, message = Exit.INTERRUPTED, "interrupted"
    except BrokenPipeError:
        os._exit(Exit.OK)
    else:
        return
    print(f"fluxfarm: {message}", file=sys.stderr)
    sys.exit(code)


@app.command()
def render(
    scene: SceneArgument,
    out: OutOption,
    rel_error: RelErrorOption = None,
    spp: SppOption = None,
    seconds: SecondsOption = None,
    integrator: IntegratorOption = None,
    size: SizeOption = None,
    crop: CropOption = None,
    png: PngOption = None,
    seed: SeedOption = 0,
    threads: Annotated[int | None, typer.Option("--threads", help="Threads of each engine process.")] = None,
    workers: Annotated[int | None, typer.Option("--workers", help="Engine processes.")] = None,
    server: ServerOption = None,
) -> None:
    """Render SCENE to an OpenEXR file. Without a service, one runs inside this command for as long as it takes."""
    options = JobOptions(rel_error, spp, seconds, integrator, size, crop, seed)
    option_members(options)
    for path in (out, png):
        if path is not None and not path.absolute().parent.is_dir():
            raise CommandError(Exit.BAD_INPUT, f"{path}: the folder {path.absolute().parent} is not there")
    found = find_scene(scene)
    from fluxfarm.cli.follow import describe, follow, outcome

    with service(server, threads, workers) as client:
        body, key = job_body(client, found, options), uuid.uuid4().hex
        try:
            job = follow(client, client.submit(body, key)["id"])
        except KeyboardInterrupt:
            _give_up(client, body, key)
            raise
        outcome(job)
        _fetch(client, job["id"], out, png, None)
    print(f"{out}: {describe(job)}")


@app.command()
def submit(
    scene: SceneArgument,
    rel_error: RelErrorOption = None,
    spp: SppOption = None,
    seconds: SecondsOption = None,
    integrator: IntegratorOption = None,
    size: SizeOption = None,
    crop: CropOption = None,
    seed: SeedOption = 0,
    priority: PriorityOption = 0,
    name: Annotated[str | None, typer.Option("--name", help="For people.")] = None,
    server: ServerOption = None,
) -> None:
    """Submit SCENE to a service and print the id of the job."""
    options = JobOptions(rel_error, spp, seconds, integrator, size, crop, seed, priority, name)
    found = find_scene(scene)
    with connect(server) as client:
        print(client.submit(job_body(client, found, options), uuid.uuid4().hex)["id"])


@app.command()
def watch(job_id: JobArgument, server: ServerOption = None) -> None:
    """Follow a job until it ends."""
    from fluxfarm.cli.follow import follow, outcome

    with connect(server) as client:
        outcome(follow(client, job_id))


@app.command()
def get(
    job_id: JobArgument,
    out: OutOption,
    png: PngOption = None,
    revision: Annotated[int | None, typer.Option("--revision", help="An older revision.")] = None,
    server: ServerOption = None,
) -> None:
    """Fetch the newest image of a job, finished or not."""
    with connect(server) as client:
        _fetch(client, job_id, out, png, revision)
    print(out)


@app.command()
def cancel(job_id: JobArgument, server: ServerOption = None) -> None:
    """Give a job up."""
    with connect(server) as client:
        print(client.call("POST", f"/v1/jobs/{job_id}:cancel")["state"])


@app.command("list")
def list_jobs(
    as_json: Annotated[bool, typer.Option("--json", help="The service's JSON.")] = False, server: ServerOption = None
) -> None:
    """List jobs, newest first."""
    from fluxfarm.cli.follow import describe

    with connect(server) as client:
        jobs: list[dict[str, Any]] = client.call("GET", "/v1/jobs")["jobs"]
    if as_json:
        print(json.dumps(jobs, indent=2))
        return
    for job in jobs:
        print(f"{job['id']}  {job['created_at']}  {job['name'] or '-'}  {describe(job)}")


@app.command()
def serve(
    host: Annotated[str | None, typer.Option("--host", help="Address to listen on.")] = None,
    port: Annotated[int | None, typer.Option("--port", help="Port to listen on; 0 takes a free one.")] = None,
    data: Annotated[Path | None, typer.Option("--data", help="Data folder.")] = None,
    workers: Annotated[int | None, typer.Option("--workers", help="Engine processes.")] = None,
    threads: Annotated[int | None, typer.Option("--threads", help="Threads of each engine process.")] = None,
    backend: Annotated[str | None, typer.Option("--backend", help="local, or dask for a farm of machines.")] = None,
    scheduler: SchedulerOption = None,
    certificates: CertificatesOption = None,
    require_sandbox: Annotated[
        bool, typer.Option("--require-sandbox", help="Do not render where the kernel cannot shut engine processes in.")
    ] = False,
) -> None:
    """Run the service until Ctrl-C or SIGTERM. Every setting is also a FLUXFARM_ variable of the environment."""
    with loading():
        from fluxfarm.cli.serving import run

    sandbox = "required" if require_sandbox else None
    options: dict[str, Any] = {"backend": backend, "scheduler": scheduler, "certificates": certificates}
    options |= {"host": host, "port": port, "data": data, "workers": workers, "threads": threads, "sandbox": sandbox}
    run(changed(from_environment(), **options))


@app.command()
def scheduler(scheduler: SchedulerOption = None, certificates: CertificatesOption = None) -> None:
    """Run the scheduler of a farm, which service and workers join, until Ctrl-C or SIGTERM."""
    from fluxfarm.cli.farming import run_node

    run_node("scheduler", changed(from_environment(), scheduler=scheduler, certificates=certificates))


@app.command()
def worker(
    scheduler: SchedulerOption = None,
    certificates: CertificatesOption = None,
    data: Annotated[Path | None, typer.Option("--data", help="Folder for files of scenes.")] = None,
    threads: Annotated[int | None, typer.Option("--threads", help="Threads of the engine process.")] = None,
) -> None:
    """Render for the services of a farm until Ctrl-C or SIGTERM; one for each machine."""
    from fluxfarm.cli.farming import run_node

    changes = {"scheduler": scheduler, "certificates": certificates, "data": data, "threads": threads}
    run_node("worker", changed(from_environment(), **changes))


@app.command()
def certificates(folder: Annotated[Path, typer.Argument(metavar="FOLDER", help="Where to write them.")]) -> None:
    """Make the certificates with which the machines of a farm know each other."""
    from fluxfarm.cli.farming import write_certificates

    write_certificates(folder)


@app.command()
def doctor() -> None:
    """Check that a service could run here."""
    from fluxfarm.doctor import examine

    marks = {True: "ok", None: "note", False: "FAILED"}
    findings = list(examine(from_environment()))
    for finding in findings:
        print(f"{marks[finding.ok]:7} {finding.name}: {finding.text}")
    if any(finding.ok is False for finding in findings):
        raise CommandError(Exit.UNREACHABLE, "a service cannot run here; see the lines marked FAILED")


@app.command()
def plan(
    scene: SceneArgument,
    rel_error: RelErrorOption = None,
    spp: SppOption = None,
    seconds: SecondsOption = None,
    integrator: IntegratorOption = None,
    size: SizeOption = None,
    crop: CropOption = None,
    seed: SeedOption = 0,
    threads: Annotated[int | None, typer.Option("--threads", help="Threads of a pilot.")] = None,
    as_json: Annotated[bool, typer.Option("--json", help="As JSON.")] = False,
) -> None:
    """Say which method and which parts of the engine SCENE needs, and why. No service is asked."""
    options = JobOptions(rel_error, spp, seconds, integrator, size, crop, seed)
    option_members(options)
    from fluxfarm.cli.planning import plan_scene

    plan_scene(scene, options, threads, as_json)


@app.command()
def chart(
    scenes: Annotated[
        list[str], typer.Argument(metavar="SCENE...", help="Scene files (.xml, .json) or built-in names.")
    ],
    integrators: Annotated[
        str, typer.Option("--integrators", help="Methods, with commas between.")
    ] = "path,photon,photon-progressive,irradiance-cache",
    peers: Annotated[
        str, typer.Option("--peers", help="Other renderers: mitsuba, cycles, luxcore; see tests/benchmarks/README.md.")
    ] = "",
    seconds: Annotated[
        float, typer.Option("--seconds", help="Longest budget of a run; four shorter ones halve it.")
    ] = 8,
    seeds: Annotated[int, typer.Option("--seeds", help="Runs of each budget.")] = 3,
    size: SizeOption = None,
    reference: Annotated[
        Path | None, typer.Option("--reference", help="OpenEXR image to compare with; default: a long run, kept.")
    ] = None,
    reference_spp: Annotated[int, typer.Option("--reference-spp", help="Samples per pixel of that long run.")] = 4096,
    out: Annotated[Path, typer.Option("-o", "--out", help="Folder to write to.")] = Path("out/chart"),
) -> None:
    """Chart errors over seconds of rendering for methods and other renderers: SVG, PNG, JSON and a page, index.html."""
    from fluxfarm.cli.charting import chart_scenes

    chart_scenes(scenes, integrators, peers, seconds, seeds, size, reference, reference_spp, out)


def _give_up(client: Any, body: dict[str, Any], key: str) -> None:
    """Cancel the job that `body` and `key` made, even if the reply to its submission was not read any more."""
    with suppress(CommandError):
        client.call("POST", f"/v1/jobs/{client.submit(body, key)['id']}:cancel")


def _fetch(client: Any, job_id: str, out: Path, png: Path | None, revision: int | None) -> None:
    part = "" if revision is None else f"/revisions/{revision}"
    client.download(f"/v1/jobs/{job_id}{part}/image.exr", out)
    if png is not None:
        client.download(f"/v1/jobs/{job_id}/preview.png", png)
