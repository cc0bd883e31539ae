"""Which files the command line sends along with a scene."""

from pathlib import Path

import pytest

from fluxfarm.cli.bundle import collect
from fluxfarm.cli.exits import CommandError, Exit


def write(folder: Path, **files: str) -> Path:
    for name, text in files.items():
        path = folder / name.replace("__", "/").replace("_", ".")
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    return folder


def test_bundle_is_the_files_that_the_scene_references_and_no_others(tmp_path: Path) -> None:
    scene = """<scene version="3.0.0">
        <default name="mesh" value="box"/>
        <include filename="parts/lights.xml"/>
        <shape type="ply"><string name="filename" value="meshes/$mesh.ply"/></shape>
    </scene>"""
    lights = '<scene><emitter type="envmap"><string name="filename" value="sky.exr"/></emitter></scene>'
    write(tmp_path, scene_xml=scene, parts__lights_xml=lights, meshes__box_ply="", sky_exr="", secret_txt="")
    bundle = collect(tmp_path / "scene.xml")
    assert bundle.entry == "scene.xml"
    assert set(bundle.files) == {"scene.xml", "parts/lights.xml", "meshes/box.ply", "sky.exr"}


def test_json_scene_is_read_alike(tmp_path: Path) -> None:
    scene = '{"type": "scene", "a": {"type": "obj", "filename": "a.obj"}, "list": [{"filename": "b.png"}]}'
    write(tmp_path, scene_json=scene, a_obj="", b_png="")
    assert set(collect(tmp_path / "scene.json").files) == {"scene.json", "a.obj", "b.png"}


def test_gltf_brings_its_buffers_and_images_from_beside_it(tmp_path: Path) -> None:
    document = """{"asset": {"version": "2.0"}, "buffers": [{"uri": "a%20b.bin"}, {"uri": "data:;base64,AAAA"}, {}],
        "images": [{"uri": "maps/a.png"}, {"bufferView": 0}]}"""
    write(tmp_path, models__a_gltf=document)
    (tmp_path / "models" / "maps").mkdir()
    for name in ("models/a b.bin", "models/maps/a.png"):
        (tmp_path / name).write_bytes(b"")
    assert set(collect(tmp_path / "models" / "a.gltf").files) == {"a.gltf", "a b.bin", "maps/a.png"}
    chunk = document.encode()
    header = b"glTF" + b"".join(n.to_bytes(4, "little") for n in (2, 20 + len(chunk), len(chunk))) + b"JSON"
    (tmp_path / "models" / "a.glb").write_bytes(header + chunk)
    assert set(collect(tmp_path / "models" / "a.glb").files) == {"a.glb", "a b.bin", "maps/a.png"}
    scene = '<scene><shape type="gltf"><string name="filename" value="models/a.glb"/></shape></scene>'
    write(tmp_path, scene_xml=scene)
    expected = {"scene.xml", "models/a.glb", "models/a b.bin", "models/maps/a.png"}
    assert set(collect(tmp_path / "scene.xml").files) == expected
    (tmp_path / "models" / "maps" / "a.png").unlink()
    with pytest.raises(CommandError, match=r"maps/a\.png"):
        collect(tmp_path / "models" / "a.gltf")


def test_reference_beside_the_scenes_folder_widens_the_bundle(tmp_path: Path) -> None:
    scene = '<scene><shape type="obj"><string name="filename" value="../meshes/a.obj"/></shape></scene>'
    write(tmp_path, scenes__one_xml=scene, meshes__a_obj="")
    bundle = collect(tmp_path / "scenes" / "one.xml")
    assert (bundle.entry, set(bundle.files)) == ("scenes/one.xml", {"scenes/one.xml", "meshes/a.obj"})


def test_missing_file_is_named_with_its_line(tmp_path: Path) -> None:
    scene = '<scene>\n\n<shape type="obj"><string name="filename" value="a.obj"/></shape></scene>'
    write(tmp_path, scene_xml=scene, scene_json='{\n "filename": "a.obj"}')
    for name, line in (("scene.xml", 3), ("scene.json", 2)):
        with pytest.raises(CommandError, match=rf"{name}:{line}: filename = 'a.obj'") as caught:
            collect(tmp_path / name)
        assert caught.value.code is Exit.BAD_INPUT


def test_absolute_reference_is_refused(tmp_path: Path) -> None:
    scene = '<scene><shape type="obj"><string name="filename" value="/etc/passwd"/></shape></scene>'
    write(tmp_path, scene_xml=scene)
    with pytest.raises(CommandError, match="relative to the scene"):
        collect(tmp_path / "scene.xml")


@pytest.mark.parametrize(
    "scene",
    [
        "<scene><shape>",
        '<!DOCTYPE s [<!ENTITY a "aaaa"><!ENTITY b "&a;&a;&a;">]><scene>&b;</scene>',
        '<scene><shape type="obj"><string name="filename" value="$unknown.obj"/></shape></scene>',
        "<a>" * 100_000,
    ],
    ids=["malformed", "entities", "unknown name", "deep"],
)
def test_scene_that_cannot_be_read_goes_alone(tmp_path: Path, scene: str) -> None:
    write(tmp_path, scene_xml=scene)
    assert set(collect(tmp_path / "scene.xml").files) == {"scene.xml"}


def test_deep_json_goes_alone(tmp_path: Path) -> None:
    write(tmp_path, scene_json="[" * 100_000)
    assert set(collect(tmp_path / "scene.json").files) == {"scene.json"}


def test_include_cycle_ends(tmp_path: Path) -> None:
    write(tmp_path, scene_xml='<scene><include filename="scene.xml"/></scene>')
    assert set(collect(tmp_path / "scene.xml").files) == {"scene.xml"}
