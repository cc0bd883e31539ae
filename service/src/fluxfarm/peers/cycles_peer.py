"""Cycles on a flat scene, in a Python that has bpy.

    cycles_peer.py FLAT.npz WIDTHxHEIGHT DEPTH SPP,SPP,... OUT.npz

Rectangles and balls that shine become Cycles' own area and point lights, which it samples best. Nothing that biases: no
clamping, no light threshold, no filter on glossy, caustics on, no adaptive sampling, no denoising.
"""

import json
import re
import sys
import tempfile
from pathlib import Path
from typing import Any

import bpy
import mathutils
import numpy as np

THREADS = 2


def shader(name: str, kind: str, inputs: dict[str, Any], **settings: str) -> bpy.types.Material:
    """A material of one node."""
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    nodes = material.node_tree.nodes
    nodes.clear()
    node, output = nodes.new(kind), nodes.new("ShaderNodeOutputMaterial")
    for setting, value in settings.items():
        setattr(node, setting, value)
    for key, value in inputs.items():
        node.inputs[key].default_value = value
    material.node_tree.links.new(node.outputs[0], output.inputs["Surface"])
    return material


def material(name: str, m: dict[str, Any]) -> bpy.types.Material:
    if m["type"] == "diffuse":
        return shader(name, "ShaderNodeBsdfDiffuse", {"Color": [*m["reflectance"], 1], "Roughness": 0})
    if m["type"] == "dielectric":
        inputs = {"Color": (1, 1, 1, 1), "Roughness": 0, "IOR": m["ior"]}
        return shader(name, "ShaderNodeBsdfGlass", inputs, distribution="GGX")
    if m["type"] == "mirror":
        inputs = {"Color": [*m["reflectance"], 1], "Roughness": 0}
        return shader(name, "ShaderNodeBsdfAnisotropic", inputs, distribution="GGX")
    inputs = {"IOR": m["eta"], "Extinction": m["k"], "Roughness": m["alpha"] ** 0.5}
    metal = {"distribution": "GGX", "fresnel_type": "PHYSICAL_CONDUCTOR"}
    return shader(name, "ShaderNodeBsdfMetallic", inputs, **metal)


def add_mesh(name: str, m: dict[str, Any], vertices: np.ndarray, faces: np.ndarray, normals: np.ndarray) -> None:
    mesh = bpy.data.meshes.new(name)
    mesh.vertices.add(len(vertices))
    mesh.vertices.foreach_set("co", vertices.astype(np.float32).ravel())
    mesh.loops.add(3 * len(faces))
    mesh.loops.foreach_set("vertex_index", faces.astype(np.int32).ravel())
    mesh.polygons.add(len(faces))
    mesh.polygons.foreach_set("loop_start", np.arange(0, 3 * len(faces), 3, dtype=np.int32))
    mesh.polygons.foreach_set("use_smooth", np.full(len(faces), len(normals) > 0))
    mesh.update()
    if len(normals):
        mesh.normals_split_custom_set_from_vertices(normals.astype(np.float32))
    mesh.materials.append(material(name, m))
    bpy.context.collection.objects.link(bpy.data.objects.new(name, mesh))


def add_light(name: str, shape: dict[str, Any]) -> None:
    """Cycles takes watts: pi L A in all for a Lambertian source of radiance L and area A."""
    radiance = np.array(shape["radiance"])
    if "radius" in shape:
        light = bpy.data.lights.new(name, "POINT")
        light.shadow_soft_size, light.use_soft_falloff = shape["radius"], False
        area = 4 * np.pi * shape["radius"] ** 2
        world = mathutils.Matrix.Translation(shape["centre"])
    else:
        light = bpy.data.lights.new(name, "AREA")
        to_world = np.array(shape["to_world"])
        light.shape = "RECTANGLE"
        light.size, light.size_y = (2 * np.linalg.norm(to_world[:3, axis]) for axis in (0, 1))
        area = light.size * light.size_y
        # Ours faces its +z, Blender's its -z: half a turn about x.
        turn = to_world[:3, :3] / np.linalg.norm(to_world[:3, :3], axis=0) * (1, -1, -1)
        world = mathutils.Matrix.Translation(to_world[:3, 3]) @ mathutils.Matrix(turn.tolist()).to_4x4()
    light.color, light.energy = (radiance / radiance.max()).tolist(), float(np.pi * area * radiance.max())
    lamp = bpy.data.objects.new(name, light)
    lamp.matrix_world, lamp.visible_camera = world, True
    bpy.context.collection.objects.link(lamp)


def lamp_body(shape: dict[str, Any], vertices: np.ndarray) -> np.ndarray:
    """The lamp's mesh a little behind the light: Cycles' lights let other light pass, ours stop it."""
    if "radius" in shape:
        centre = np.array(shape["centre"])
        return np.asarray(centre + 0.998 * (vertices - centre))
    x_axis, y_axis = np.array(shape["to_world"])[:3, 0], np.array(shape["to_world"])[:3, 1]
    facing = np.cross(x_axis, y_axis)
    return np.asarray(vertices - 1e-4 * np.linalg.norm(x_axis) * facing / np.linalg.norm(facing))


def add_camera(camera: dict[str, Any]) -> None:
    data = bpy.data.cameras.new("camera")
    data.sensor_fit, data.angle = "HORIZONTAL", np.radians(camera["fov"])
    back = np.array(camera["origin"]) - camera["target"]
    back /= np.linalg.norm(back)
    right = np.cross(camera["up"], back)
    right /= np.linalg.norm(right)
    rows = np.eye(4)
    rows[:3] = np.stack([right, np.cross(back, right), back, camera["origin"]], 1)
    eye = bpy.data.objects.new("camera", data)
    eye.matrix_world = mathutils.Matrix(rows.tolist())
    bpy.context.collection.objects.link(eye)
    bpy.context.scene.camera = eye


def add_sky(radiance: list[float]) -> None:
    world = bpy.data.worlds.new("sky")
    world.use_nodes = True
    world.node_tree.nodes["Background"].inputs["Color"].default_value = (*radiance, 1)
    bpy.context.scene.world = world


def settings(width: int, height: int, depth: int) -> None:
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.render.resolution_x, scene.render.resolution_y = width, height
    scene.render.resolution_percentage = 100
    scene.render.threads_mode, scene.render.threads = "FIXED", THREADS
    scene.render.image_settings.file_format = "OPEN_EXR"
    scene.render.image_settings.color_depth = "32"
    cycles = scene.cycles
    cycles.device = "CPU"
    cycles.pixel_filter_type, cycles.filter_width = "BOX", 1
    bounces = depth - 2  # theirs counts neither the camera's ray nor the one to the light
    cycles.max_bounces = cycles.diffuse_bounces = cycles.glossy_bounces = cycles.transmission_bounces = bounces
    cycles.sample_clamp_direct = cycles.sample_clamp_indirect = cycles.blur_glossy = cycles.light_sampling_threshold = 0
    cycles.caustics_reflective = cycles.caustics_refractive = True
    cycles.use_adaptive_sampling = cycles.use_denoising = False


def render(spp: int, seed: int, folder: Path) -> tuple[np.ndarray, float]:
    """(height, width, 3) and the seconds of rendering without synchronisation, as Cycles writes them into its file."""
    scene = bpy.context.scene
    scene.cycles.samples, scene.cycles.seed = spp, seed
    scene.render.filepath = str(folder / "image.exr")
    bpy.ops.render.render(write_still=True)
    found = re.search(
        rb"cycles\.[^\0]*\.render_time\0string\0....([0-9:.]+)", (folder / "image.exr").read_bytes(), re.S
    )
    assert found is not None, "Cycles wrote no render_time"
    seconds = 0.0
    for part in found[1].decode().split(":"):
        seconds = 60 * seconds + float(part)
    image = bpy.data.images.load(scene.render.filepath, check_existing=False)
    image.colorspace_settings.name = "Non-Color"
    pixels = np.empty(len(image.pixels), np.float32)
    image.pixels.foreach_get(pixels)
    return pixels.reshape(image.size[1], image.size[0], -1)[::-1, :, :3], seconds


def main() -> None:
    flat, size, depth, counts, out = sys.argv[1:]
    width, height = map(int, size.split("x"))
    bpy.ops.wm.read_factory_settings(use_empty=True)
    with np.load(flat) as arrays:
        head = json.loads(str(arrays["head"]))
        for i, shape in enumerate(head["shapes"]):
            vertices, faces, normals = (arrays[f"{part}_{i}"] for part in ("vertices", "faces", "normals"))
            if "radiance" in shape:
                add_light(f"light {i}", shape)
                vertices = lamp_body(shape, vertices)
            add_mesh(f"shape {i}", shape["material"], vertices, faces, normals)
    add_camera(head["camera"])
    add_sky(head["sky"])
    settings(width, height, int(depth))
    with tempfile.TemporaryDirectory() as folder:
        runs = [render(int(spp), seed, Path(folder)) for seed, spp in enumerate(counts.split(","))]
    images, seconds = zip(*runs, strict=True)
    np.savez(out, names=["Cycles"], images=np.stack(images)[None], seconds=[seconds])


if __name__ == "__main__":
    main()
