"""The bundle of files that a scene is made of, known by their digests."""

import hashlib
import json
import re
from dataclasses import dataclass

from fluxfarm.errors import BadBundle

SHA256_PATTERN = r"^[0-9a-f]{64}$"
MAX_PATH_LENGTH = 512
MAX_COMPONENT_LENGTH = 200
MAX_FILES = 10_000


@dataclass(frozen=True, slots=True)
class SceneBundle:
    """A scene file and everything it references: path inside the bundle -> SHA-256 in lower-case hexadecimal."""

    entry: str
    files: dict[str, str]

    def digest(self) -> str:
        """SHA-256 of the bundle in its canonical JSON form; equal bundles have equal digests."""
        canonical = json.dumps({"entry": self.entry, "files": self.files}, sort_keys=True, separators=(",", ":"))
        return hashlib.sha256(canonical.encode()).hexdigest()


def check_bundle(bundle: SceneBundle) -> None:
    """Raise BadBundle unless every path stays inside the bundle, every digest is one and the entry is listed."""
    if not 1 <= len(bundle.files) <= MAX_FILES:
        raise BadBundle("scene.files", len(bundle.files), f"expected 1 to {MAX_FILES} files")
    for path, sha256 in bundle.files.items():
        fault = path_fault(path)
        if fault is not None:
            raise BadBundle(f"scene.files[{path!r}]", path, fault)
        if re.match(SHA256_PATTERN, sha256) is None:
            raise BadBundle(f"scene.files[{path!r}]", sha256, "expected a SHA-256 as 64 lower-case hexadecimal digits")
    for path in bundle.files:
        parts = path.split("/")
        for length in range(1, len(parts)):
            folder = "/".join(parts[:length])
            if folder in bundle.files:
                raise BadBundle(f"scene.files[{path!r}]", path, f"{folder!r} is a file, so it cannot be a folder too")
    if bundle.entry not in bundle.files:
        raise BadBundle("scene.entry", bundle.entry, "expected one of the paths in scene.files")


def path_fault(path: str) -> str | None:
    """What is wrong with `path` as a place inside a bundle, as "expected ..."; None if nothing is."""
    if not path or len(path) > MAX_PATH_LENGTH:
        return f"expected a path of 1 to {MAX_PATH_LENGTH} characters"
    if "\\" in path or any(ord(character) < 32 or ord(character) == 127 for character in path):
        return "expected a path without backslashes and control characters"
    parts = path.split("/")
    if path.startswith("/") or re.match(r"^[A-Za-z]:", path) or "" in parts:
        return "expected a path relative to the bundle, without empty parts"
    if "." in parts or ".." in parts:
        return "expected a path that stays inside the bundle, without '.' and '..'"
    if any(len(part.encode(errors="surrogatepass")) > MAX_COMPONENT_LENGTH for part in parts):
        return f"expected parts of at most {MAX_COMPONENT_LENGTH} bytes"
    try:
        path.encode()
    except UnicodeEncodeError:
        return "expected a path that can be written as UTF-8"
    return None
