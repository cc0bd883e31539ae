"""Scenes at the limits of numbers, as Mitsuba dictionaries: sizes, places, intensities, materials and triangles far
from the usual.

Most are one room, stressed in a way that must not change its picture, or must change it by a known factor."""

from typing import Any

from hard_scenes import Node, area, diffuse, point, rectangle, room, rotate, scale, scene, sphere, translate

LOOK = {"origin": [0, 0, 0.95], "target": [0, -0.3, -1], "fov": 70}
GLASS = {"type": "dielectric", "int_ior": 1.5, "ext_ior": 1.0}
MIRROR = {"type": "conductor", "material": "none"}


def rough_metal(alpha: float) -> Node:
    return {"type": "roughconductor", "alpha": alpha, "distribution": "ggx", "material": "none"}


def rough_glass(alpha: float) -> Node:
    return GLASS | {"type": "roughdielectric", "alpha": alpha, "distribution": "ggx"}


def chamber(albedo: float = 0.6, light: float = 1.0, metal: Node | None = None, **more: Node) -> Node:
    """A closed room under a wide lamp, with a ball of glass, one of rough metal and one of chalk."""
    parts = room(albedo)
    parts["lamp"] = rectangle([translate(0, 0.98, 0), rotate([1, 0, 0], 90), scale(0.6, 0.6, 1)], emitter=area(light))
    parts["glass"] = sphere([-0.45, -0.6, -0.2], 0.35, bsdf=GLASS)
    parts["metal"] = sphere([0.5, -0.65, -0.3], 0.3, bsdf=metal or rough_metal(0.3))
    parts["chalk"] = sphere([0.1, -0.8, 0.2], 0.2, bsdf=diffuse(0.6))
    return scene(**LOOK, **parts | more)


def furnace(albedo: float = 0.5, light: float = 1.0) -> Node:
    """A closed room whose walls shine and reflect, with a ball of glass: radiance is light / (1 - albedo) (G1)."""
    parts = {name: wall | {"emitter": area(light)} for name, wall in room(albedo).items()}
    return scene(**LOOK, **parts, glass=sphere([-0.45, -0.6, -0.2], 0.35, bsdf=GLASS))


def placed(node: Node, size: float = 1, shift: float = 0) -> Node:
    """The scene made so many times as large and then moved so far (m) along each axis. Its picture stays: radiance does
    not change, and a point light shines more by the square of the size."""

    def place(part: Any) -> Any:
        kind = part.get("type") if isinstance(part, dict) else None
        if kind in ("rectangle", "sphere", "obj"):
            return part | {"to_world": [*part.get("to_world", []), scale(size, size, size), translate(*[shift] * 3)]}
        if kind == "point":
            return point([x * size + shift for x in part["position"]], part["intensity"]["value"][0] * size**2)
        if kind == "perspective":
            look = part["to_world"][0]
            ends = {end: [x * size + shift for x in look[end]] for end in ("origin", "target")}
            return part | {"to_world": [look | ends], "near_clip": 0.01 * size, "far_clip": 1e4 * size}
        return part

    return {name: place(part) for name, part in node.items()}


def in_a_plain(node: Node) -> Node:
    """The scene above a plain of 2 km."""
    place = [translate(0, -1, 0), rotate([1, 0, 0], -90), scale(1000, 1000, 1)]
    return node | {"plain": rectangle(place, bsdf=diffuse(0.5))}


def dark_box(walls: dict[str, Node]) -> Node:
    """A closed box in bright light from outside, and none within: what is seen there came through its seams."""
    return scene(**LOOK, **walls, sky={"type": "constant", "radiance": {"type": "rgb", "value": [1000.0] * 3}})


def dark_box_with_a_slit() -> Node:
    """Its left wall is smaller by a thousandth."""
    walls = room(0.6)
    walls["left"]["to_world"] = [scale(0.999, 0.999, 1), *walls["left"]["to_world"]]
    return dark_box(walls)


# Cuts of each side of the sliver box: triangles up to ten million times as long as they are wide.
SLIVERS = "slivers.obj"
CUTS = (-1.0, -0.3, -1e-2, -1e-4, -1e-7, 1e-7, 1e-4, 1e-2, 0.3, 1.0)


def sliver_obj() -> str:
    """The cube [-1, 1]^3 as an OBJ file, each side cut at CUTS along one of its directions."""
    vertices: list[str] = []
    faces: list[str] = []
    for axis in range(3):
        for side in (-1.0, 1.0):
            first = len(vertices) + 1
            for cut in CUTS:
                for end in (-1.0, 1.0):
                    corner = {axis: side, (axis + 1) % 3: cut, (axis + 2) % 3: end}
                    vertices.append("v " + " ".join(repr(corner[k]) for k in range(3)))
            strips = range(first, first + 2 * (len(CUTS) - 1), 2)
            faces += [f"f {i} {i + 1} {i + 3} {i + 2}" for i in strips]
    return "\n".join(vertices + faces) + "\n"


def sliver_walls(albedo: float = 0.6) -> dict[str, Node]:
    bsdf = {"type": "twosided", "bsdf": diffuse(albedo)}
    return {"walls": {"type": "obj", "filename": SLIVERS, "face_normals": True, "bsdf": bsdf}}


def chamber_of_slivers() -> Node:
    walls = room(0)
    return {name: part for name, part in chamber().items() if name not in walls} | sliver_walls()


def doubled(node: Node) -> Node:
    """Every wall twice in the same place."""
    return node | {f"{name}_again": node[name] for name in room(0) if name in node}


def grazing_sun(cosine: float) -> Node:
    """A wide floor of albedo 0.5, lit almost along itself by a sun of 1 W/m^2."""
    floor = rectangle([rotate([1, 0, 0], -90), scale(100, 100, 1)], bsdf=diffuse(0.5))
    sun = {
        "type": "directional",
        "direction": [(1 - cosine**2) ** 0.5, -cosine, 0],
        "irradiance": {"type": "rgb", "value": [1.0] * 3},
    }
    return scene([0, 5, 0], [0, 0, 0], 40, floor=floor, sun=sun)


def grazing_view(slope: float) -> Node:
    """A wide floor of albedo 0.5 under an even sky of 1, seen almost along itself and filling the picture."""
    floor = rectangle([rotate([1, 0, 0], -90), scale(1000, 1000, 1)], bsdf=diffuse(0.5))
    return scene([0, 0.1, 0], [0, 0.1 - slope, -1], 0.01 * slope, floor=floor, sky={"type": "constant"})


def hidden_lamps(count: int, radiance: float) -> Node:
    """The chamber, and so many lamps above its ceiling, shut in."""
    parts: dict[str, Node] = {}
    for i in range(count):
        place = [translate(-0.9 + 1.8 * (i % 100) / 99, 1.5, -0.9 + 1.8 * (i // 100) / 99), rotate([1, 0, 0], 90)]
        parts[f"lamp_{i}"] = rectangle([*place, scale(0.004, 0.004, 1)], emitter=area(radiance))
    return chamber(**parts)


def white_sphere(albedo: float) -> Node:
    """A wall of radius 1 around a point light of 1 W/sr (G2): radiance albedo / (1 - albedo) / pi. Few photons, for
    each is stored at some 1 / (1 - albedo) places."""
    wall = sphere([0, 0, 0], 1, flip_normals=True, bsdf=diffuse(albedo))
    node = scene([0, 0, 0.5], [0, 0, -1], 60, wall=wall, lamp=point([0, 0, 0], 1.0))
    return node | {"integrator": {"type": "photon", "photons": 200}}
