"""Each numerical stress with what its picture has to be."""

from collections.abc import Callable
from dataclasses import dataclass

import stress_scenes as scenes
from hard_scenes import Node, diffuse, sphere

METHODS = ("path", "photon", "photon-progressive", "irradiance-cache")


@dataclass(frozen=True)
class Case:
    """The mean of the picture has to be `closed`, or `factor` times that of the scene `plain` by the same method; or
    the engine has to refuse the scene with these words. `tolerance` is relative; of a picture that has to be black,
    absolute."""

    name: str
    scene: Callable[[], Node]
    closed: float | None = None
    plain: Callable[[], Node] | None = None
    factor: float = 1.0
    refused: str = ""
    tolerance: float = 0.02
    size: str = "24x24"
    spp: int = 8
    warning: str = ""  # words of the warning that the stress has to come with

    @property
    def expected(self) -> str:
        if self.refused:
            return "refused"
        if self.closed is not None:
            return f"{self.closed:.6g}"
        return "unstressed" if self.factor == 1 else f"unstressed x {self.factor:g}"


def white(albedo: float) -> float:
    return albedo / (1 - albedo) / 3.141592653589793


def with_mote(radius: float) -> Node:
    return scenes.chamber(mote=sphere([0.3, 0, 0.3], radius, bsdf=diffuse(0.5)))


# Named, so that its picture is rendered once for all cases that are compared with it.
def mirror_ball() -> Node:
    return scenes.chamber(metal=scenes.MIRROR)


def glass_of(ior: float) -> Node:
    return scenes.chamber(glass=sphere([-0.45, -0.6, -0.2], 0.35, bsdf=scenes.GLASS | {"int_ior": ior}))


def rough_glass_ball(alpha: float) -> Node:
    return scenes.chamber(glass=sphere([-0.45, -0.6, -0.2], 0.35, bsdf=scenes.rough_glass(alpha)))


def no_glass() -> Node:
    return {name: part for name, part in scenes.chamber().items() if name != "glass"}


CHALK = sphere([0.1, -0.8, 0.2], 0.2)


def black_chalk() -> Node:
    return scenes.chamber(chalk=CHALK | {"bsdf": diffuse(0)})


def dark_box() -> Node:
    return scenes.dark_box(scenes.room(0.6))


CHAMBER = scenes.chamber
# Of light of 1000 around a dark box: of some million reflections one slips out where walls meet within the rounding of
# their places. A slit of a thousandth of the box lets in twelve times as much.
LEAK = 0.05

CASES = [
    Case("room x 1e-4", lambda: scenes.placed(CHAMBER(), 1e-4), plain=CHAMBER),
    Case("room x 1e4", lambda: scenes.placed(CHAMBER(), 1e4), plain=CHAMBER),
    Case("room x 1e-7", lambda: scenes.placed(CHAMBER(), 1e-7), plain=CHAMBER),
    Case("room x 1e-10", lambda: scenes.placed(CHAMBER(), 1e-10), refused="radius"),
    Case("room x 1e18", lambda: scenes.placed(CHAMBER(), 1e18), refused="m from the origin"),
    Case("room moved 1e4 m", lambda: scenes.placed(CHAMBER(), shift=1e4), plain=CHAMBER, warning="rounded"),
    Case("room moved 1e6 m", lambda: scenes.placed(CHAMBER(), shift=1e6), plain=CHAMBER, warning="rounded"),
    Case(
        "room x 1e-4 on a plain of 2 km",
        lambda: scenes.in_a_plain(scenes.placed(CHAMBER(), 1e-4)),
        plain=CHAMBER,
        warning="near_clip",
    ),
    Case("furnace x 1e-4", lambda: scenes.placed(scenes.furnace(), 1e-4), closed=2),
    Case("furnace moved 1e6 m", lambda: scenes.placed(scenes.furnace(), shift=1e6), closed=2),
    Case("walls of slivers", scenes.chamber_of_slivers, plain=CHAMBER),
    Case("every wall twice", lambda: scenes.doubled(CHAMBER()), plain=CHAMBER),
    Case("mote of radius 1e-15 m", lambda: with_mote(1e-15), plain=CHAMBER),
    Case("mote of radius 1e-30 m", lambda: with_mote(1e-30), refused="no area"),
    Case("mote of radius 1e-40 m", lambda: with_mote(1e-40), refused="no area"),
    Case("ball of albedo 1e-40", lambda: CHAMBER(chalk=CHALK | {"bsdf": diffuse(1e-40)}), plain=black_chalk),
    Case("dark box", dark_box, closed=0, tolerance=LEAK),
    Case("dark box x 1e-4", lambda: scenes.placed(dark_box(), 1e-4), closed=0, tolerance=LEAK),
    Case("dark box moved 1e6 m", lambda: scenes.placed(dark_box(), shift=1e6), closed=0, tolerance=LEAK),
    Case("dark box of slivers", lambda: scenes.dark_box(scenes.sliver_walls()), closed=0, tolerance=LEAK),
    Case("sun at 1e-3 rad to the floor", lambda: scenes.grazing_sun(1e-3), closed=0.5e-3 / 3.141592653589793),
    Case("floor seen at 1e-3 rad", lambda: scenes.grazing_view(1e-3), closed=0.5),
    Case("albedo 0.999", lambda: scenes.white_sphere(0.999), closed=white(0.999), tolerance=0.1, size="8x8", spp=16),
    Case("light x 1e-8", lambda: CHAMBER(light=1e-8), plain=CHAMBER, factor=1e-8),
    Case("light x 1e8", lambda: CHAMBER(light=1e8), plain=CHAMBER, factor=1e8),
    Case("light x 1e-20", lambda: CHAMBER(light=1e-20), plain=CHAMBER, factor=1e-20),
    Case("light x 1e30", lambda: CHAMBER(light=1e30), plain=CHAMBER, factor=1e30),
    Case("light x 1e-40", lambda: CHAMBER(light=1e-40), refused="expected 0 or from 1e-20"),
    Case("light x 1e38", lambda: CHAMBER(light=1e38), refused="expected 0 or from 1e-20"),
    Case("light x 1e300", lambda: CHAMBER(light=1e300), refused="radiance"),
    Case("light infinite", lambda: CHAMBER(light=float("inf")), refused="scene.json"),
    Case("albedo not a number", lambda: CHAMBER(albedo=float("nan")), refused="scene.json"),
    Case("index of refraction 1", lambda: glass_of(1), plain=no_glass),
    Case("mirror of roughness 0", lambda: CHAMBER(metal=scenes.rough_metal(0)), plain=mirror_ball),
    Case("mirror of roughness 1e-6", lambda: CHAMBER(metal=scenes.rough_metal(1e-6)), plain=mirror_ball),
    Case("glass of roughness 0", lambda: rough_glass_ball(0), plain=CHAMBER),
    Case("glass of roughness 1e-6", lambda: rough_glass_ball(1e-6), plain=CHAMBER),
    Case("one pixel", lambda: scenes.furnace(0.2), closed=1.25, size="1x1", spp=64, tolerance=0.05),
    Case("10,000 lamps, one in the room", lambda: scenes.hidden_lamps(9999, 1.0), plain=CHAMBER),
]
