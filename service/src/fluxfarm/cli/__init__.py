"""The `fluxfarm` command."""

from fluxfarm.cli.commands import main

__all__ = ["main"]
