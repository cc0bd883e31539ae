"""Scenes on which path tracing is known to fail (accuracy catalogue 4.8), as Mitsuba dictionaries."""

import math
from typing import Any

Node = dict[str, Any]

SIDE = 32


def diffuse(reflectance: float) -> Node:
    return {"type": "diffuse", "reflectance": {"type": "rgb", "value": [reflectance] * 3}}


def area(radiance: float) -> Node:
    return {"type": "area", "radiance": {"type": "rgb", "value": [radiance] * 3}}


def point(position: list[float], intensity: float) -> Node:
    return {"type": "point", "position": position, "intensity": {"type": "rgb", "value": [intensity] * 3}}


def sphere(center: list[float], radius: float, **more: Node | bool) -> Node:
    return {"type": "sphere", "center": center, "radius": radius, **more}


def rectangle(to_world: list[Node], **more: Node) -> Node:
    """`to_world` as a product of matrices is written: the last step is taken first."""
    return {"type": "rectangle", "to_world": to_world[::-1], **more}


def translate(*value: float) -> Node:
    return {"type": "translate", "value": list(value)}


def scale(*value: float) -> Node:
    return {"type": "scale", "value": list(value)}


def rotate(axis: list[float], angle: float) -> Node:
    return {"type": "rotate", "axis": axis, "angle": angle}


def scene(origin: list[float], target: list[float], fov: float, max_depth: int = -1, **parts: Node) -> Node:
    up = [0, 0, 1] if origin[0] == target[0] and origin[2] == target[2] else [0, 1, 0]
    sensor = {
        "type": "perspective",
        "fov": fov,
        "to_world": [{"type": "lookat", "origin": origin, "target": target, "up": up}],
        "film": {"type": "hdrfilm", "width": SIDE, "height": SIDE, "rfilter": {"type": "box"}},
    }
    return {"type": "scene", "integrator": {"type": "path", "max_depth": max_depth}, "sensor": sensor, **parts}


def room(reflectance: float, omit: str = "") -> dict[str, Node]:
    """Walls of the cube [-1, 1]^3, facing inwards; all but `omit`."""
    turns = {
        "floor": rotate([1, 0, 0], -90),
        "ceiling": rotate([1, 0, 0], 90),
        "left": rotate([0, 1, 0], 90),
        "right": rotate([0, 1, 0], -90),
        "far": rotate([0, 1, 0], 0),
        "near": rotate([0, 1, 0], 180),
    }
    walls = {name: rectangle([turn, translate(0, 0, -1)], bsdf=diffuse(reflectance)) for name, turn in turns.items()}
    walls.pop(omit, None)
    return walls


LOOK = {"origin": [0, 0, 0.95], "target": [0, -0.3, -1], "fov": 70}


def bulb() -> Node:
    """A point light in a ball of glass, in a room that nothing else lights."""
    glass = sphere([0, 0.4, 0], 0.15, bsdf={"type": "dielectric", "int_ior": 1.5, "ext_ior": 1.0})
    return scene(**LOOK, **room(0.5), bulb=glass, lamp=point([0, 0.4, 0], 1.0))


def bulb_beside_a_lamp() -> Node:
    """The same beside an open lamp of a fifth of its power."""
    return bulb() | {"open": point([0.5, 0.4, 0.3], 0.2)}


def bulb_in_a_mirror() -> Node:
    """The floor below the bulb, seen in a mirror that fills the view: specular, diffuse, specular."""
    mirror = rectangle([translate(0, 0, -0.9)], bsdf={"type": "conductor", "material": "none"})
    return bulb() | {"mirror": mirror, "open": point([0.5, 0.4, 0.3], 0.2)}


def bulb_near_fog() -> Node:
    """The bulb, and a little fog behind the camera."""
    medium = {
        "type": "homogeneous",
        "albedo": {"type": "rgb", "value": [0.5] * 3},
        "sigma_t": {"type": "rgb", "value": [1.0] * 3},
    }
    return bulb() | {"fog": sphere([0, -0.8, 0.9], 0.05, bsdf={"type": "null"}, interior=medium)}


def keyhole() -> Node:
    """Sun through a window in the ceiling, of 30 x 30 cm, the only light of a room."""
    edge, rest = 0.15, 0.85
    parts = room(0.7, omit="ceiling")
    for name, x, z, half_x, half_z in (
        ("a", -(edge + rest / 2), 0, rest / 2, 1),
        ("b", edge + rest / 2, 0, rest / 2, 1),
        ("c", 0, -(edge + rest / 2), edge, rest / 2),
        ("d", 0, edge + rest / 2, edge, rest / 2),
    ):
        place = [translate(x, 1, z), rotate([1, 0, 0], 90), scale(half_x, half_z, 1)]
        parts[f"ceiling_{name}"] = rectangle(place, bsdf={"type": "twosided", "bsdf": diffuse(0.7)})
    sun = {"type": "directional", "direction": [0.2, -1, -0.3], "irradiance": {"type": "rgb", "value": [50.0] * 3}}
    return scene(**LOOK, **parts, sun=sun)


def white_sphere(albedo: float, max_depth: int = -1) -> Node:
    """An integrating sphere of radius 1 with a point light of 1 W/sr in its centre (G2): seen from inside."""
    wall = sphere([0, 0, 0], 1, flip_normals=True, bsdf=diffuse(albedo))
    return scene([0, 0, 0.5], [0, 0, -1], 60, max_depth, wall=wall, lamp=point([0, 0, 0], 1.0))


def white_sphere_radiance(albedo: float, reflections: float = math.inf) -> float:
    """What leaves its wall after at most so many reflections."""
    lost = 0.0 if math.isinf(reflections) else albedo ** (reflections + 1)
    return (albedo - lost) / (1 - albedo) / math.pi


def ten_thousand_lights() -> Node:
    """100 x 100 small squares of very different brightness under the ceiling of a room."""
    parts = room(0.5)
    for i in range(10_000):
        x, z = -0.9 + 1.8 * (i % 100) / 99, -0.9 + 1.8 * (i // 100) / 99
        place = [translate(x, 0.9, z), rotate([1, 0, 0], 90), scale(0.004, 0.004, 1)]
        parts[f"lamp_{i}"] = rectangle(place, emitter=area(0.1 * 1000 ** ((i * 7919 % 10_000) / 10_000)))
    return scene(**LOOK, **parts)


def peaked_fog() -> Node:
    """A box of fog that scatters almost straight on (g = 0.99) before a lamp and a wall."""
    medium = {
        "type": "homogeneous",
        "albedo": {"type": "rgb", "value": [0.99] * 3},
        "sigma_t": {"type": "rgb", "value": [10.0] * 3},
        "phase": {"type": "hg", "g": 0.99},
    }
    fog = {
        "type": "cube",
        "to_world": [scale(0.8, 0.8, 0.2), translate(0, 0, -0.2)],
        "bsdf": {"type": "null"},
        "interior": medium,
    }
    lamp = rectangle([translate(0, 0.2, -0.95), scale(0.3, 0.3, 1)], emitter=area(5.0))
    return scene(**LOOK, **room(0.5), fog=fog, lamp=lamp)


def hidden_bright_lamp() -> Node:
    """A lamp of 10,000 times the power of the open one stands in a box that lets light out by a slit of 1 cm."""
    box = diffuse(0.5)
    two_sided = {"type": "twosided", "bsdf": box}
    parts = room(0.5)
    sides = {
        "bottom": ([translate(0.5, -0.99, -0.5)], [rotate([1, 0, 0], -90)]),
        "left": ([translate(0.3, -0.79, -0.5)], [rotate([0, 1, 0], 90)]),
        "right": ([translate(0.7, -0.79, -0.5)], [rotate([0, 1, 0], -90)]),
        "front": ([translate(0.5, -0.79, -0.3)], []),
        "back": ([translate(0.5, -0.79, -0.7)], []),
    }
    for name, (place, turn) in sides.items():
        parts[f"box_{name}"] = rectangle([*place, *turn, scale(0.2, 0.2, 1)], bsdf=two_sided)
    lid = [translate(0.495, -0.59, -0.5), rotate([1, 0, 0], -90), scale(0.195, 0.2, 1)]
    parts["box_lid"] = rectangle(lid, bsdf=two_sided)
    parts["bright"] = sphere([0.45, -0.8, -0.5], 0.03, emitter=area(2000.0))
    parts["dim"] = sphere([-0.5, 0.5, 0], 0.1, emitter=area(0.2))
    return scene(**LOOK, **parts)
