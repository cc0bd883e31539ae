"""Arguments and options that several commands take."""

from pathlib import Path
from typing import Annotated

import typer

from fluxfarm.settings import PREFIX

SceneArgument = Annotated[str, typer.Argument(metavar="SCENE", help="Scene file (.xml, .json) or built-in name.")]
JobArgument = Annotated[str, typer.Argument(metavar="JOB", help="Id of the job.")]
OutOption = Annotated[Path, typer.Option("-o", "--out", help="OpenEXR file to write.")]
PngOption = Annotated[Path | None, typer.Option("--png", help="Also write a PNG for the eye.")]
ServerOption = Annotated[
    str | None, typer.Option("--server", envvar=PREFIX + "SERVER", help="Address of a service, http://HOST:PORT.")
]
RelErrorOption = Annotated[float | None, typer.Option("--rel-error", help="Goal: relative error, for example 0.05.")]
SppOption = Annotated[int | None, typer.Option("--spp", help="Goal: samples per pixel.")]
SecondsOption = Annotated[float | None, typer.Option("--seconds", help="Goal: seconds of rendering.")]
IntegratorOption = Annotated[
    str | None, typer.Option("--integrator", help="auto, path, photon, photon-progressive or irradiance-cache.")
]
SizeOption = Annotated[str | None, typer.Option("--size", metavar="WxH", help="Frame size in pixels.")]
CropOption = Annotated[str | None, typer.Option("--crop", metavar="X,Y,W,H", help="Part of the frame to render.")]
SeedOption = Annotated[int, typer.Option("--seed", help="Another seed gives an independent image.")]
SchedulerOption = Annotated[
    str | None, typer.Option("--scheduler", help="Address of the farm's scheduler, tls://HOST:PORT.")
]
CertificatesOption = Annotated[
    Path | None, typer.Option("--certificates", help="Folder that `fluxfarm certificates` wrote.")
]
PriorityOption = Annotated[int, typer.Option("--priority", help="Higher goes first.")]
