"""A Mitsuba scene of ours as plain arrays, for renderers of other formats: triangles, materials, lights, a camera.

Reads what the benchmarks' scenes use and nothing more: rectangle, cube, sphere and ply; diffuse, dielectric, conductor
and roughconductor, each within a twosided or not; area lights, a constant sky. Spheres become meshes of equal area with
smooth normals; vertex normals of a ply are weighted by angle, as Mitsuba does. A light is told both ways, as a shape
and as a mesh.
"""

import json
import xml.etree.ElementTree as ET
from pathlib import Path
from typing import Any

import numpy as np

from fluxfarm.peers.icosphere import icosphere

SQUARE = np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]], float)
CUBE = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], float)
CUBE_SIDES = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
SPHERE_SUBDIVISIONS = 5
BLACK = {"type": "diffuse", "reflectance": [0, 0, 0]}  # of a lamp without a bsdf


def numbers(text: str) -> list[float]:
    return [float(v) for v in text.replace(",", " ").split()]


def parameter(element: ET.Element, name: str, default: str | None = None) -> str:
    for child in element:
        if child.get("name") == name and child.get("value") is not None:
            return str(child.get("value"))
    if default is None:
        raise ValueError(f"<{element.tag} type={element.get('type')!r}> has no {name}")
    return default


def colour(element: ET.Element, name: str, default: str = "0.5") -> list[float]:
    values = numbers(parameter(element, name, default))
    return values * 3 if len(values) == 1 else values


def matrix(shape: ET.Element) -> np.ndarray:
    """(4, 4) of the shape's or camera's to_world."""
    total = np.eye(4)
    for step in shape.findall("transform/*"):
        if step.tag == "matrix":
            total = np.array(numbers(step.attrib["value"])).reshape(4, 4) @ total
            continue
        given = {axis: float(step.get(axis, step.get("value", 1 if step.tag == "scale" else 0))) for axis in "xyz"}
        one = np.eye(4)
        if step.tag == "scale":
            one[:3, :3] = np.diag(list(given.values()))
        elif step.tag == "translate":
            one[:3, 3] = list(given.values())
        elif step.tag == "rotate":
            x, y, z = np.array(list(given.values())) / np.linalg.norm(list(given.values()))
            angle = np.radians(float(step.attrib["angle"]))
            cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
            one[:3, :3] += np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross
        else:
            raise ValueError(f"<{step.tag}> in a transform is not read here")
        total = one @ total
    return total


def smooth_normals(vertices: np.ndarray, faces: np.ndarray) -> np.ndarray:
    """(n, 3) means of the faces' normals, weighted by the angle of each at the vertex."""
    corners = vertices[faces]
    edges = np.roll(corners, -1, 1) - corners
    face_normals = np.cross(edges[:, 0], edges[:, 1])
    face_normals /= np.linalg.norm(face_normals, axis=1, keepdims=True)
    edges /= np.linalg.norm(edges, axis=2, keepdims=True)
    total = np.zeros_like(vertices)
    for corner in range(3):
        angle = np.arccos(np.clip(-np.sum(edges[:, corner] * edges[:, corner - 1], 1), -1, 1))
        np.add.at(total, faces[:, corner], angle[:, None] * face_normals)
    return np.asarray(total / np.linalg.norm(total, axis=1, keepdims=True))


def read_ply(path: Path) -> tuple[np.ndarray, np.ndarray]:
    """Vertices and faces of a binary PLY that holds positions and triangles alone, as million.py writes it."""
    head, body = path.read_bytes().split(b"end_header\n", 1)
    vertices, faces = (int(head.split(f"element {what} ".encode())[1].split()[0]) for what in ("vertex", "face"))
    points = np.frombuffer(body, "<f4", 3 * vertices).reshape(-1, 3).astype(float)
    lists = np.frombuffer(body, [("count", "u1"), ("indices", "<u4", 3)], faces, 12 * vertices)
    return points, lists["indices"].astype(np.int64)


def mesh(shape: ET.Element, folder: Path) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Vertices (n, 3), faces (m, 3), normals (n, 3) or (0, 3) for flat ones; in the world."""
    flat, kind = np.zeros((0, 3)), shape.get("type")
    world = matrix(shape)
    if kind == "sphere":
        unit, faces = icosphere(SPHERE_SUBDIVISIONS)
        centre, radius = sphere(shape)
        return unit * radius + centre, faces, unit / np.linalg.norm(unit, axis=1, keepdims=True)
    if kind == "ply":
        points, faces = read_ply(folder / parameter(shape, "filename"))
        return points, faces, smooth_normals(points, faces)
    corners, sides = (SQUARE, [[0, 1, 2, 3]]) if kind == "rectangle" else (CUBE, CUBE_SIDES)
    if kind not in ("rectangle", "cube"):
        raise ValueError(f"shape {kind} is not read here")
    faces = np.array([[a, b, c] for a, b, c, _ in sides] + [[a, c, d] for a, _, c, d in sides])
    return corners @ world[:3, :3].T + world[:3, 3], faces, flat


def sphere(shape: ET.Element) -> tuple[list[float], float]:
    """Centre and radius."""
    point = next(child for child in shape if child.get("name") == "center")
    return [float(point.attrib[axis]) for axis in "xyz"], float(parameter(shape, "radius"))


def material(bsdf: ET.Element) -> dict[str, Any]:
    inner = bsdf.find("bsdf")
    if bsdf.get("type") == "twosided" and inner is not None:
        return material(inner)
    kind = bsdf.get("type")
    if kind == "diffuse":
        return {"type": kind, "reflectance": colour(bsdf, "reflectance")}
    if kind == "dielectric":
        return {"type": kind, "ior": float(parameter(bsdf, "int_ior")) / float(parameter(bsdf, "ext_ior"))}
    if kind == "conductor" and parameter(bsdf, "material") == "none":
        return {"type": "mirror", "reflectance": colour(bsdf, "specular_reflectance", "1")}
    if kind == "roughconductor" and parameter(bsdf, "distribution") == "ggx":
        alpha = float(parameter(bsdf, "alpha"))
        return {"type": kind, "alpha": alpha, "eta": colour(bsdf, "eta"), "k": colour(bsdf, "k")}
    raise ValueError(f"bsdf {kind} is not read here")


def camera(sensor: ET.Element) -> dict[str, Any]:
    look = sensor.find("transform/lookat")
    if look is not None:
        view = {name: numbers(value) for name, value in look.attrib.items()}
    else:
        _, up, ahead, origin = matrix(sensor)[:3].T
        view = {"origin": origin.tolist(), "target": (origin + ahead).tolist(), "up": up.tolist()}
    return {"fov": float(parameter(sensor, "fov")), **view}


def write(scene: Path, out: Path) -> None:
    """`out`, an .npz: `head`, JSON of camera, sky and shapes; vertices_i, faces_i, normals_i of the i-th shape."""
    root = ET.fromstring(scene.read_text())
    named = {bsdf.get("id"): bsdf for bsdf in root.findall("bsdf")}
    shapes: list[dict[str, Any]] = []
    arrays: dict[str, np.ndarray] = {}
    for i, shape in enumerate(root.findall("shape")):
        reference, own, emitter = shape.find("ref"), shape.find("bsdf"), shape.find("emitter")
        bsdf = own if reference is None else named[reference.get("id")]
        entry: dict[str, Any] = {"material": BLACK if bsdf is None else material(bsdf)}
        if emitter is not None:
            entry["radiance"] = colour(emitter, "radiance")
            if shape.get("type") == "sphere":
                entry["centre"], entry["radius"] = sphere(shape)
            else:
                entry["to_world"] = matrix(shape).tolist()
        shapes.append(entry)
        arrays[f"vertices_{i}"], arrays[f"faces_{i}"], arrays[f"normals_{i}"] = mesh(shape, scene.parent)
    sky = root.find("emitter")
    sensor = root.find("sensor")
    assert sensor is not None
    head = {"camera": camera(sensor), "sky": [0, 0, 0] if sky is None else colour(sky, "radiance"), "shapes": shapes}
    np.savez(out, allow_pickle=False, head=json.dumps(head), **arrays)
