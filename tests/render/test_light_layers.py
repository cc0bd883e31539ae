"""The light layers of the EXR: those that the scene can have, and they add up to beauty."""

from pathlib import Path

import numpy as np
import pytest
from conftest import ROOT, Layers, beauty, render_alone
from farm import Farm

ALL = {"direct", "specular", "caustic", "indirect", "volume"}
OF = {
    "cornell": {"direct", "indirect"},  # no glass, mirror or medium
    "cornell-glass": {"direct", "specular", "caustic", "indirect"},
    "interior": {"direct", "indirect"},
}


def light_layers(layers: Layers) -> set[str]:
    return {name.partition(".")[0] for name in layers} & ALL


def total(layers: Layers, names: set[str]) -> np.ndarray:
    """(height, width, 3) float64: the sum of the layers of those names."""
    return np.sum([np.stack([layers[f"{name}.{c}"] for c in "RGB"], axis=-1) for name in names], axis=0, dtype=float)


@pytest.mark.parametrize("scene", OF)
def test_layers_add_up_to_beauty(tmp_path: Path, scene: str) -> None:
    layers = render_alone(ROOT / "scenes" / scene / "scene.xml", tmp_path / "out.exr", "--size", "64x64", "--spp", 32)
    assert light_layers(layers) == OF[scene]
    np.testing.assert_allclose(total(layers, OF[scene]), beauty(layers), rtol=1e-5, atol=1e-6)
    for name in OF[scene]:
        rest = total(layers, OF[scene] - {name})
        assert not np.allclose(rest, beauty(layers), rtol=1e-2), f"twin: {name} adds something"


def test_the_caustic_lies_under_the_glass_ball(tmp_path: Path) -> None:
    scene = ROOT / "scenes" / "cornell-glass" / "scene.xml"
    layers = render_alone(scene, tmp_path / "out.exr", "--size", "64x64", "--spp", 64)
    caustic = layers["caustic.G"]
    assert caustic[52:60, 38:50].mean() > 4 * caustic[52:60, 4:16].mean(), "right of the middle of the floor, not left"


def test_service_writes_the_same_layers(farms: list[Farm], tmp_path: Path) -> None:
    farms.append(farm := Farm(tmp_path, workers=2))
    layers = farm.layers(farm.submit())
    assert light_layers(layers) == OF["cornell-glass"]
    np.testing.assert_allclose(total(layers, OF["cornell-glass"]), beauty(layers), rtol=1e-5, atol=1e-6)
