"""`fluxfarm keys`: the API keys of a service."""

from typing import Annotated, Any

import typer

from fluxfarm.cli.connect import connect
from fluxfarm.cli.options import ServerOption

keys_app = typer.Typer(help="Make, list and drop the API keys of a service.", no_args_is_help=True)


@keys_app.command("add")
def add_key(
    name: Annotated[str, typer.Argument(metavar="NAME", help="Whose it is.")],
    scope: Annotated[
        str, typer.Option("--scope", help="read, submit or admin; each contains those before it.")
    ] = "submit",
    jobs: Annotated[int | None, typer.Option("--jobs", help="Most unfinished jobs at once.")] = None,
    bytes_a_day: Annotated[int | None, typer.Option("--bytes-a-day", help="Most uploaded bytes in 24 hours.")] = None,
    samples_a_day: Annotated[
        int | None, typer.Option("--samples-a-day", help="Most camera samples in 24 hours, over all pixels.")
    ] = None,
    server: ServerOption = None,
) -> None:
    """Make a key and print it, the only time."""
    quota = {"jobs": jobs, "bytes_a_day": bytes_a_day, "samples_a_day": samples_a_day}
    with connect(server) as client:
        print(client.call("POST", "/v1/keys", json={"name": name, "scope": scope, "quota": quota})["key"])


@keys_app.command("list")
def list_keys(server: ServerOption = None) -> None:
    """List keys, oldest first, with what they used in 24 hours."""
    with connect(server) as client:
        keys: list[dict[str, Any]] = client.call("GET", "/v1/keys")["keys"]
    for key in keys:
        used = key["usage"]
        print(
            f"{key['id']}  {key['created_at']}  {key['scope']:6}  {key['name']}  "
            f"{used['jobs']} jobs, {used['bytes']} bytes, {used['samples']} samples"
        )


@keys_app.command("drop")
def drop_key(
    key_id: Annotated[str, typer.Argument(metavar="ID", help="Id of the key.")], server: ServerOption = None
) -> None:
    """Drop a key: it opens nothing any more."""
    with connect(server) as client:
        client.call("DELETE", f"/v1/keys/{key_id}")
