"""Bad scenes through the real service and engine: each fails its own job with one clear reason, and nothing else."""

import json
import os
import signal
import struct
import zlib
from collections.abc import Iterator
from pathlib import Path

import pytest
from conftest import same_bits
from farm import Farm

# Of the service's memory over all bad scenes a second time.
MOST_GROWTH = 4 << 20

FILM = '<film type="hdrfilm"><integer name="width" value="8"/><integer name="height" value="8"/></film>'
SENSOR = f'<sensor type="perspective">{FILM}</sensor>'
LAMP = '<emitter type="constant"><rgb name="radiance" value="1, 1, 1"/></emitter>'


def scene(*parts: str) -> str:
    return '<scene version="3.0.0">\n' + "\n".join(parts) + "\n</scene>\n"


def ply_shape(name: str) -> str:
    return f'<shape type="ply"><string name="filename" value="{name}"/></shape>'


def painted(name: str) -> str:
    bitmap = f'<texture type="bitmap" name="reflectance"><string name="filename" value="{name}"/></texture>'
    return f'<shape type="sphere"><bsdf type="diffuse">{bitmap}</bsdf></shape>'


def ascii_ply(vertices: list[str], faces: list[str], claimed: int | None = None) -> bytes:
    head = f"ply\nformat ascii 1.0\nelement vertex {claimed or len(vertices)}\n"
    head += "property float x\nproperty float y\nproperty float z\n"
    head += f"element face {len(faces)}\nproperty list uchar int vertex_indices\nend_header\n"
    return (head + "".join(line + "\n" for line in vertices + faces)).encode()


TRIANGLE = ["0 0 0", "1 0 0", "0 1 0"]
BINARY_HEAD = (
    b"ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
    b"element face 1\nproperty list uchar int vertex_indices\nend_header\n"
)
NAN_PLY = BINARY_HEAD + struct.pack("<9fB3i", 0, 0, 0, 1, float("nan"), 0, 0, 1, 0, 3, 0, 1, 2)
RING = json.dumps(
    {"asset": {"version": "2.0"}, "nodes": [{"children": [1]}, {"children": [0]}], "scenes": [{"nodes": [0]}]}
).encode()
LYING_BUFFER = json.dumps(
    {
        "asset": {"version": "2.0"},
        "nodes": [{"mesh": 0}],
        "scenes": [{"nodes": [0]}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}],
        "bufferViews": [{"buffer": 0, "byteLength": 4_000_000_000}],
        "buffers": [{"byteLength": 4_000_000_000, "uri": "data:application/octet-stream;base64,AAAA"}],
    }
).encode()
GLTF_SHAPE = '<shape type="gltf"><string name="filename" value="a.gltf"/></shape>'
HDR_BOMB = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 60000 +X 60000\n"
BOMB = '<!DOCTYPE s [<!ENTITY a "aaaaaaaa"><!ENTITY b "&a;&a;&a;&a;">]>' + scene(SENSOR, LAMP)


def png_bomb(side: int) -> bytes:
    """A PNG that claims so many pixels each way, and begins well."""

    def chunk(name: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))

    head = chunk(b"IHDR", struct.pack(">IIBBBBB", side, side, 8, 6, 0, 0, 0))
    return b"\x89PNG\r\n\x1a\n" + head + chunk(b"IDAT", zlib.compress(bytes(1 << 20))) + chunk(b"IEND", b"")


# name, files beside the scene, scene text, words that the reason must have
CASES = [
    ("malformed XML", {}, '<scene version="3.0.0">\n<sensor', ["scene.xml"]),
    ("unknown plugin", {}, scene(SENSOR, LAMP, '<shape type="torus"/>'), ["scene.xml:4", "torus"]),
    (
        "unknown parameter",
        {},
        scene(SENSOR, LAMP, '<shape type="sphere"><float name="raduis" value="1"/></shape>'),
        ["scene.xml:4", "raduis"],
    ),
    ("missing file", {}, scene(SENSOR, LAMP, ply_shape("none.ply")), ["scene.xml:4", "none.ply"]),
    ("path out of the bundle", {}, scene(SENSOR, LAMP, ply_shape("../../etc/passwd")), ["scene.xml:4", "passwd"]),
    ("truncated PLY", {"a.ply": BINARY_HEAD + b"\0" * 7}, scene(SENSOR, LAMP, ply_shape("a.ply")), ["a.ply"]),
    (
        "lying PLY",
        {"a.ply": ascii_ply(TRIANGLE, ["3 0 1 2"], 4_000_000_000)},
        scene(SENSOR, LAMP, ply_shape("a.ply")),
        ["a.ply"],
    ),
    (
        "index out of range",
        {"a.ply": ascii_ply(TRIANGLE, ["3 0 1 7"])},
        scene(SENSOR, LAMP, ply_shape("a.ply")),
        ["a.ply", "7"],
    ),
    ("NaN vertex", {"a.ply": NAN_PLY}, scene(SENSOR, LAMP, ply_shape("a.ply")), ["a.ply", "nan"]),
    (
        "only degenerate triangles",
        {"a.ply": ascii_ply(["0 0 0"] * 3, ["3 0 1 2"])},
        scene(SENSOR, LAMP, ply_shape("a.ply")),
        ["a.ply"],
    ),
    ("missing image", {}, scene(SENSOR, LAMP, painted("none.png")), ["scene.xml:4", "none.png"]),
    (
        "no image",
        {"a.png": b"hello"},
        scene(SENSOR, LAMP, painted("a.png")),
        ["a.png", "expected EXR, HDR, PNG or JPEG"],
    ),
    ("image of many pixels", {"a.hdr": HDR_BOMB}, scene(SENSOR, LAMP, painted("a.hdr")), ["a.hdr", "60000 x 60000"]),
    ("no sensor", {}, scene(LAMP), ["sensor"]),
    (
        "size 0",
        {},
        scene(SENSOR.replace('"width" value="8"', '"width" value="0"'), LAMP),
        ["scene.xml:2", "width", "0"],
    ),
    ("huge size", {}, scene(SENSOR.replace('value="8"', 'value="1000000"'), LAMP), ["scene.xml:2", "1000000"]),
    ("deep nesting", {}, scene('<bsdf type="twosided">' * 100_000), ["scene.xml"]),
    ("entity bomb", {}, BOMB, ["scene.xml"]),
    (
        "file that includes itself",
        {},
        scene(SENSOR, LAMP, '<include filename="scene.xml"/>'),
        ["scene.xml:4", "include"],
    ),
    (
        "image that is a bomb",
        {"a.png": png_bomb(65_000)},
        scene(SENSOR, LAMP, painted("a.png")),
        ["a.png", "65000 x 65000"],
    ),
    (
        "index beyond all numbers",
        {"a.obj": b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 99999999999999999999\n"},
        scene(SENSOR, LAMP, '<shape type="obj"><string name="filename" value="a.obj"/></shape>'),
        ["a.obj:4", "99999999999999999999"],
    ),
    ("nodes in a ring", {"a.gltf": RING}, scene(SENSOR, LAMP, GLTF_SHAPE), ["a.gltf", "nodes"]),
    ("buffer that lies", {"a.gltf": LYING_BUFFER}, scene(SENSOR, LAMP, GLTF_SHAPE), ["a.gltf", "4000000000"]),
]


@pytest.fixture(scope="module")
def farm(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Farm]:
    """One service for all cases: it must outlive every one of them."""
    farm = Farm(tmp_path_factory.mktemp("farm"))
    yield farm
    farm.service.end(signal.SIGTERM)


def submit(farm: Farm, text: str, files: dict[str, bytes]) -> str:
    uploaded = {name: farm.client.upload(content) for name, content in {"scene.xml": text, **files}.items()}
    body = {"scene": {"entry": "scene.xml", "files": uploaded}, "goal": {"spp": 1}}
    reply = farm.client.http.post("/v1/jobs", json=body)
    assert reply.status_code == 201, reply.text
    return str(reply.json()["id"])


@pytest.mark.parametrize(("name", "files", "text", "words"), CASES, ids=[case[0] for case in CASES])
def test_bad_scene_fails_its_job_with_place_and_value(
    farm: Farm, name: str, files: dict[str, bytes], text: str, words: list[str]
) -> None:
    job = farm.client.finish(submit(farm, text, files))
    assert job["state"] == "FAILED", name
    for word in words:
        assert word in job["reason"], job["reason"]
    workers = farm.client.http.get("/v1/workers").json()["workers"]
    assert sum(worker["restarts"] for worker in workers) == 0, "the engine crashed"


def test_scene_without_light_is_black_with_a_warning(farm: Farm) -> None:
    job = farm.client.finish(submit(farm, scene(SENSOR, '<shape type="sphere"/>'), {}))
    assert job["state"] == "SUCCEEDED"
    assert any("light" in warning for warning in job["warnings"])


def test_bad_scenes_change_no_other_job_and_leave_nothing_in_the_service(farm: Farm) -> None:
    good = scene(SENSOR, LAMP, '<shape type="sphere"/>')

    def all_cases() -> None:
        for _, files, text, _ in CASES:
            assert farm.client.finish(submit(farm, text, files))["state"] == "FAILED"

    undisturbed = submit(farm, good, {})
    farm.client.succeed(undisturbed)
    all_cases()  # whatever is kept for the next time is kept now
    before = holds(farm)
    disturbed = submit(farm, good, {})
    all_cases()
    farm.client.succeed(disturbed)
    assert same_pixels(farm, undisturbed, disturbed)
    after = holds(farm)
    assert after["open files"] <= before["open files"] + 4
    assert after["bytes"] <= before["bytes"] + MOST_GROWTH


def holds(farm: Farm) -> dict[str, int]:
    """What the service process holds."""
    process = Path(f"/proc/{farm.service.process.pid}")
    pages = int((process / "statm").read_text().split()[1])
    return {"open files": len(list((process / "fd").iterdir())), "bytes": pages * os.sysconf("SC_PAGE_SIZE")}


def same_pixels(farm: Farm, *jobs: str) -> bool:
    """Whether two jobs have the same layers; the files name their jobs."""
    a, b = (farm.layers(job_id) for job_id in jobs)
    return same_bits(a, b)
