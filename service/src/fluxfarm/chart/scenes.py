"""The scenes of a chart, and how they are made the same for other renderers."""

import hashlib
import re
import shutil
from dataclasses import dataclass
from pathlib import Path

# Where a scene leaves paths unbounded, and the other renderer has to be told a number.
LONGEST_PATH = 1024


@dataclass(frozen=True, slots=True)
class ChartScene:
    """A scene file and all files that it needs: path inside their common folder -> place on this machine."""

    name: str
    entry: str
    files: dict[str, Path]

    @property
    def path(self) -> Path:
        """The scene file."""
        return self.files[self.entry]

    def digest(self) -> str:
        """SHA-256 over the paths and contents of all files."""
        whole = hashlib.sha256(self.entry.encode())
        for path, place in sorted(self.files.items()):
            with place.open("rb") as file:
                whole.update(f"\0{path}\0{hashlib.file_digest(file, 'sha256').hexdigest()}".encode())
        return whole.hexdigest()


def boxed(scene: ChartScene, folder: Path) -> ChartScene:
    """A copy in `folder` whose pixels are means over their squares, the one filter that all renderers have; without a
    sampler, as each brings its own, and with the values of its `<default>`s. What is not XML is returned as it is."""
    if scene.path.suffix.lower() != ".xml":
        return scene
    files: dict[str, Path] = {}
    for path, place in scene.files.items():
        files[path] = folder / path
        files[path].parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(place, files[path])
    xml = files[scene.entry].read_text()
    defaults = dict(re.findall(r'<default name="([^"]*)" value="([^"]*)"\s*/>', xml))
    for name in sorted(defaults, key=len, reverse=True):
        xml = xml.replace(f"${name}", defaults[name])
    xml = re.sub(r"<default\b[^>]*/>", "", xml)
    xml = re.sub(r"<rfilter\b[^>]*/>|<rfilter\b.*?</rfilter>", "", xml, flags=re.DOTALL)
    xml = re.sub(r"<sampler\b[^>]*/>|<sampler\b.*?</sampler>", "", xml, flags=re.DOTALL)
    files[scene.entry].write_text(xml.replace("</film>", '<rfilter type="box"/></film>'))
    return ChartScene(scene.name, scene.entry, files)


def path_depth(scene: ChartScene) -> int:
    """`max_depth` of a boxed XML scene, LONGEST_PATH where it has no bound."""
    found = re.search(r'<integer name="max_depth" value="(\d+)"', scene.path.read_text())
    return LONGEST_PATH if found is None else int(found[1])
