"""The `fluxfarm` command."""


def main() -> None:
    """Entry point."""
