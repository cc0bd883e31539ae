"""The arrows between rooms, as the include and import lines have them. `a <- b` in the design reads "b uses a"."""

import ast
import re
from pathlib import Path

ROOT = Path(__file__).parents[2]

# Each room of the engine and the rooms that it may use. Rooms of equal rank do not use each other.
SHADING = {"support", "math", "sampling", "geometry"}
ENGINE = {
    "support": set(),
    "math": {"support"},
    "sampling": {"support", "math"},
    "film": {"support", "math"},
    "geometry": SHADING - {"geometry"},
    "textures": {"support", "math"},
    "materials": SHADING | {"textures"},
    "emitters": SHADING,
    "media": SHADING,
    "accel": SHADING,
    "scene": SHADING | {"textures", "materials", "emitters", "media", "accel"},
    "integrators": SHADING | {"textures", "materials", "emitters", "media", "accel", "scene", "film"},
    "io": {"support", "math", "film", "scene", "textures", "materials", "media", "sampling"},
    "worker": {*SHADING, "textures", "materials", "emitters", "media", "accel", "scene", "integrators", "film", "io"},
}
ENGINE["apps"] = {*ENGINE["worker"], "worker"}
# Of these rooms io may use the plain descriptions only.
IO_HEADERS = {
    "scene": {"scene/description.h"},
    "materials": {"materials/material_description.h"},
    "media": {"media/medium_description.h"},
    "textures": {"textures/texture_description.h", "textures/texture_image.h"},
    "sampling": {"sampling/pixel_filter.h"},
}
# Third-party headers and the only places that may see them.
THIRD_PARTY = {
    r"embree[34]/": ["accel/"],
    r"(Imf|Imath|Iex|OpenEXR)": ["io/"],
    r"pugixml": ["io/"],
    r"png\.h": ["io/"],
    r"OpenImageIO/": ["io/image_module.cpp"],
    r".*\.pb\.h": ["worker/codec.cpp"],
    r"nlohmann/": ["io/", "worker/plan.cpp", "apps/"],
    r"CLI/": ["apps/"],
    r"nanoflann\.hpp": ["apps/nanoflann_map.h"],
    r"seccomp\.h": ["worker/sandbox.cpp"],
}

# Each room of the service and the rooms that it may use; `errors` and `failpoints` belong to all.
SERVICE = {
    "domain": set(),
    "plot": set(),
    "ports": {"domain"},
    "orchestrator": {"domain", "ports"},
    "adapters": {"domain", "ports", "settings"},
    "api": {"domain", "ports", "orchestrator", "settings", "plot"},
    "peers": set(),
    "chart": {"plot", "peers"},
}
GENERATED_PROTOCOL = "fluxfarm.adapters.protocol"
CODEC = "adapters/engine/codec.py"


def engine_breaches(sources: Path, apps: Path) -> list[str]:
    """Each forbidden include as "file: header"."""
    breaches = []
    for file in sorted([*sources.rglob("*.h"), *sources.rglob("*.cpp"), *apps.rglob("*.h"), *apps.rglob("*.cpp")]):
        inside = file.is_relative_to(sources)
        place = file.relative_to(sources).as_posix() if inside else f"apps/{file.name}"
        room = place.split("/")[0]
        for header in re.findall(r'^\s*#\s*include\s*[<"]([^>"]+)[>"]', file.read_text(), re.MULTILINE):
            used = header.split("/")[0]
            ours = used in ENGINE and "/" in header
            wrong = header.startswith(".")  # rooms are named from the root, so that this test can see them
            wrong |= ours and used != room and used not in ENGINE[room]
            wrong |= ours and room == "io" and header not in IO_HEADERS.get(used, {header})
            for pattern, places in THIRD_PARTY.items():
                wrong |= bool(re.match(pattern, header)) and not any(place.startswith(p) for p in places)
            if wrong:
                breaches.append(f"{place}: {header}")
    return breaches


def imported(node: ast.AST, place: str) -> list[str]:
    """The full names that an import statement in the file `place` of the package asks for; of anything else, none."""
    if isinstance(node, ast.Import):
        return [alias.name for alias in node.names]
    if not isinstance(node, ast.ImportFrom):
        return []
    here = ["fluxfarm", *place.split("/")[:-1]]
    start = here[: len(here) + 1 - node.level] if node.level else []
    return [".".join([*start, *([node.module] if node.module else []), alias.name]) for alias in node.names]


def service_breaches(package: Path) -> list[str]:
    """Each forbidden import as "file: module"."""
    breaches = []
    for file in sorted(package.rglob("*.py")):
        place = file.relative_to(package).as_posix()
        room = place.removesuffix(".py").split("/")[0]
        allowed = SERVICE.get(room)  # None: app, settings, errors and the commands wire the rooms together
        for node in ast.walk(ast.parse(file.read_text())):
            for module in imported(node, place):
                parts = module.split(".")
                if parts[0] != "fluxfarm" or len(parts) < 2:
                    continue
                wrong = allowed is not None and parts[1] not in {room, "errors", "failpoints", *allowed}
                wrong |= module.startswith(GENERATED_PROTOCOL) and place != CODEC
                if wrong:
                    breaches.append(f"{place}: {module}")
    return breaches


def test_engine_includes_follow_the_arrows() -> None:
    assert engine_breaches(ROOT / "engine" / "src", ROOT / "engine" / "apps") == []


def test_service_imports_follow_the_arrows() -> None:
    assert service_breaches(ROOT / "service" / "src" / "fluxfarm") == []


def write_files(folder: Path, files: dict[str, str]) -> None:
    for name, text in files.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(text)


def test_forbidden_includes_and_imports_are_found(tmp_path: Path) -> None:
    engine = {
        "math/a.h": '#include "film/film.h"\n',
        "film/b.h": '#include <embree3/rtcore.h>\n#include "math/vec.h"\n',
        "io/c.cpp": '#include "scene/scene.h"\n#include "scene/description.h"\n',
        "worker/d.cpp": "#include <fluxfarm/v1/engine.pb.h>\n",
        "emitters/e.h": '#include "materials/bsdf.h"\n',
        "math/g.h": '#  include "../film/film.h"\n',
    }
    write_files(tmp_path / "src", engine)
    (tmp_path / "apps").mkdir()
    (tmp_path / "apps" / "f.cpp").write_text('#include "worker/plan.h"\n#include <pugixml.hpp>\n')
    assert engine_breaches(tmp_path / "src", tmp_path / "apps") == [
        "apps/f.cpp: pugixml.hpp",
        "emitters/e.h: materials/bsdf.h",
        "film/b.h: embree3/rtcore.h",
        "io/c.cpp: scene/scene.h",
        "math/a.h: film/film.h",
        "math/g.h: ../film/film.h",
        "worker/d.cpp: fluxfarm/v1/engine.pb.h",
    ]
    service = {
        "api/routes.py": "from fluxfarm import adapters, errors\nfrom fluxfarm.orchestrator import orchestrator\n",
        "domain/job.py": "from fluxfarm.adapters import blobs\nimport fluxfarm.errors\n",
        "domain/pass_.py": "from ..adapters.blobs import Blobs\nfrom .job import Job\n",
        "cli.py": "from fluxfarm.adapters.protocol import engine_pb2\nfrom fluxfarm.adapters import blobs\n",
    }
    write_files(tmp_path / "service", service)
    assert service_breaches(tmp_path / "service") == [
        "api/routes.py: fluxfarm.adapters",
        "cli.py: fluxfarm.adapters.protocol.engine_pb2",
        "domain/job.py: fluxfarm.adapters.blobs",
        "domain/pass_.py: fluxfarm.adapters.blobs.Blobs",
    ]
