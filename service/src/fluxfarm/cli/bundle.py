"""Finds the files that a scene references, so that exactly those are sent.

Reads Mitsuba XML and its JSON form just well enough for that: `filename` members, `<include>`, and `$name` from
`<default>`; and of glTF the URIs of buffers and images, which are relative to the glTF file.
What it cannot parse it sends alone; the engine then reports the error with file and line.
"""

import hashlib
import json
import os
import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from urllib.parse import unquote
from xml.parsers import expat

from fluxfarm.cli.exits import CommandError, Exit

MAX_INCLUDE_DEPTH = 15
GLTF_SUFFIXES = {".gltf", ".glb"}


@dataclass(frozen=True, slots=True)
class Reference:
    """A file named in a scene file, as it stands there, and the line."""

    name: str
    line: int
    include: bool


@dataclass(frozen=True, slots=True)
class LocalBundle:
    """Files to send: path inside the bundle -> place on this machine."""

    entry: str
    files: dict[str, Path]

    def digests(self) -> dict[str, str]:
        """Path inside the bundle -> SHA-256."""
        found: dict[str, str] = {}
        for path, place in self.files.items():
            with place.open("rb") as file:
                found[path] = hashlib.file_digest(file, "sha256").hexdigest()
        return found


def collect(scene: Path) -> LocalBundle:
    """The scene file and everything that it references; raises CommandError for what is not there."""
    entry = scene.resolve()
    places = {entry}
    _collect_from(entry, entry.parent, places, {}, 0)
    root = Path(os.path.commonpath([place.parent for place in places]))
    files = {place.relative_to(root).as_posix(): place for place in sorted(places)}
    return LocalBundle(entry.relative_to(root).as_posix(), files)


def _collect_from(file: Path, base: Path, places: set[Path], names: dict[str, str], depth: int) -> None:
    """Add what `file` references; relative names start at `base`, the folder of the scene file."""
    if depth > MAX_INCLUDE_DEPTH:
        raise CommandError(Exit.BAD_INPUT, f"{file}: includes are nested deeper than {MAX_INCLUDE_DEPTH}")
    for reference in references(file, names):
        name = _substituted(reference.name, names)
        if name is None:
            continue  # an unknown $name: the engine says so, with the line
        if Path(name).is_absolute():
            raise CommandError(
                Exit.BAD_INPUT,
                f"{file}:{reference.line}: filename = {name!r}, expected a path relative to the scene file",
            )
        place = (base / name).resolve()
        if not place.is_file():
            raise CommandError(
                Exit.BAD_INPUT, f"{file}:{reference.line}: filename = {name!r}: there is no file {place}, expected one"
            )
        if place not in places:
            places.add(place)
            if reference.include:
                _collect_from(place, base, places, names, depth + 1)
            elif place.suffix.lower() in GLTF_SUFFIXES:
                _collect_from(place, place.parent, places, {}, depth + 1)


def references(file: Path, names: dict[str, str]) -> Iterator[Reference]:
    """The files that `file` names; `<default>` values are added to `names`. Nothing if it cannot be parsed."""
    try:
        text = file.read_bytes()
    except OSError as error:
        raise CommandError(Exit.BAD_INPUT, f"{file}: cannot be read: {error.strerror}") from None
    if file.suffix.lower() == ".json":
        yield from _json_references(text, names)
    elif file.suffix.lower() == ".xml":
        yield from _xml_references(text, names)
    elif file.suffix.lower() in GLTF_SUFFIXES:
        yield from _gltf_references(text)


def _xml_references(text: bytes, names: dict[str, str]) -> list[Reference]:
    found: list[Reference] = []
    parser = expat.ParserCreate()

    def start(tag: str, attributes: dict[str, str]) -> None:
        line = parser.CurrentLineNumber
        if tag == "default" and "name" in attributes:
            names.setdefault(attributes["name"], attributes.get("value", ""))
        elif tag == "include" and "filename" in attributes:
            found.append(Reference(attributes["filename"], line, True))
        elif tag == "string" and attributes.get("name") == "filename":
            found.append(Reference(attributes.get("value", ""), line, False))

    def refuse_doctype(*_: object) -> None:
        raise expat.ExpatError("a document type is not part of a scene")

    parser.StartElementHandler = start
    parser.StartDoctypeDeclHandler = refuse_doctype
    try:
        parser.Parse(text, True)
    except (expat.ExpatError, ValueError):
        return []
    return found


def _json_references(text: bytes, names: dict[str, str]) -> list[Reference]:
    try:
        root = json.loads(text)
    except (ValueError, RecursionError):
        return []
    found: list[Reference] = []
    waiting: list[Any] = [root]
    while waiting:
        node = waiting.pop()
        if isinstance(node, dict):
            name = node.get("filename")
            if isinstance(name, str):
                line = text.count(b"\n", 0, max(0, text.find(json.dumps(name).encode()))) + 1
                found.append(Reference(name, line, node.get("type") == "include"))
            if node.get("type") == "default" and isinstance(node.get("name"), str):
                names.setdefault(node["name"], str(node.get("value", "")))
            waiting.extend(node.values())
        elif isinstance(node, list):
            waiting.extend(node)
    return found


def _gltf_references(text: bytes) -> list[Reference]:
    """Files that buffers and images name; a binary file has its document after 20 bytes."""
    if text[:4] == b"glTF":
        text = text[20 : 20 + int.from_bytes(text[12:16], "little")]
    try:
        root = json.loads(text)
    except (ValueError, RecursionError):
        return []
    found: list[Reference] = []
    for kind in ("buffers", "images"):
        elements = root.get(kind) if isinstance(root, dict) else None
        for element in elements if isinstance(elements, list) else []:
            uri = element.get("uri") if isinstance(element, dict) else None
            if isinstance(uri, str) and not uri.startswith("data:"):
                line = text.count(b"\n", 0, max(0, text.find(json.dumps(uri).encode()))) + 1
                found.append(Reference(unquote(uri), line, False))
    return found


def _substituted(text: str, names: dict[str, str]) -> str | None:
    """`text` with every $name replaced; None if one is not known."""
    for name in sorted(names, key=len, reverse=True):
        text = text.replace(f"${name}", names[name])
    return None if re.search(r"\$\w", text) else text
