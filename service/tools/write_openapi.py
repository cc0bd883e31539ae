"""Writes service/openapi.json from the routes; a test compares the two. Run it after changing a route."""

import json
from pathlib import Path

from fluxfarm.app import create_app

TARGET = Path(__file__).resolve().parent.parent / "openapi.json"

if __name__ == "__main__":
    TARGET.write_text(json.dumps(create_app().openapi(), indent=2, sort_keys=True) + "\n")
