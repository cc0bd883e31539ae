"""LuxCore on a flat scene, in a Python that has pyluxcore.

    luxcore_peer.py FLAT.npz WIDTHxHEIGHT DEPTH SPP,SPP,... OUT.npz
    luxcore_peer.py FLAT.npz WIDTHxHEIGHT DEPTH SECONDS OUT.npz caustics

Its path tracer for the CPU with the Sobol sampler; no clamping, no denoising. The second form renders once with the
caustic cache of PhotonGI and once without, for so long each, photons included. Lights are triangles: its own round ones
are never met by a ray. Its rough metal has Schlick's distribution, which is GGX's with alpha^2 as the roughness, and
Schlick's masking, which is near Smith's.
"""

import json
import os
import sys
import time
from typing import Any

import numpy as np
import pyluxcore

THREADS = 2
POLL_S = 0.01


def texture(name: str, values: list[float]) -> dict[str, Any]:
    return {f"scene.textures.{name}.type": "constfloat3", f"scene.textures.{name}.value": values}


def material(name: str, m: dict[str, Any]) -> dict[str, Any]:
    key = f"scene.materials.{name}"
    if m["type"] == "diffuse":
        return {f"{key}.type": "matte", f"{key}.kd": m["reflectance"]}
    if m["type"] == "dielectric":
        given = {"type": "glass", "kr": [1, 1, 1], "kt": [1, 1, 1], "interiorior": m["ior"], "exteriorior": 1}
        return {f"{key}.{what}": value for what, value in given.items()}
    if m["type"] == "mirror":
        return {f"{key}.type": "mirror", f"{key}.kr": m["reflectance"]}
    fresnel = f"scene.textures.{name}_fresnel"
    return {
        f"{fresnel}.type": "fresnelconst",
        f"{fresnel}.n": m["eta"],
        f"{fresnel}.k": m["k"],
        f"{key}.type": "metal2",
        f"{key}.fresnel": f"{name}_fresnel",
        f"{key}.uroughness": m["alpha"],
        f"{key}.vroughness": m["alpha"],
    }


def properties(values: dict[str, Any]) -> pyluxcore.Properties:
    props = pyluxcore.Properties()
    for key, value in values.items():
        props.Set(pyluxcore.Property(key, value))
    return props


def scene_of(flat: str, width: int, height: int) -> pyluxcore.Scene:
    scene = pyluxcore.Scene()
    with np.load(flat) as arrays:
        head = json.loads(str(arrays["head"]))
        camera = head["camera"]
        values: dict[str, Any] = {
            "scene.camera.type": "perspective",
            "scene.camera.lookat.orig": camera["origin"],
            "scene.camera.lookat.target": camera["target"],
            "scene.camera.up": camera["up"],
            "scene.camera.fieldofview": camera["fov"],
            "scene.camera.autofocus.enable": False,
            # Film rows run from the bottom in [0, height), the camera's from the top in (-1, height - 1]: a shift.
            "scene.camera.screenwindow": [-1, 1, (-height - 2) / width, (height - 2) / width],
        }
        if any(head["sky"]):
            values |= {"scene.lights.sky.type": "constantinfinite", "scene.lights.sky.color": head["sky"]}
        for i, shape in enumerate(head["shapes"]):
            vertices, faces, normals = (arrays[f"{part}_{i}"] for part in ("vertices", "faces", "normals"))
            smooth = [tuple(n) for n in normals.tolist()] or None
            points, triangles = [tuple(v) for v in vertices.tolist()], [tuple(f) for f in faces.tolist()]
            scene.DefineMesh(f"mesh{i}", points, triangles, smooth, None, None, None)
            values |= material(f"material{i}", shape["material"])
            if "radiance" in shape:
                values[f"scene.materials.material{i}.emission"] = shape["radiance"]
                # Else meshes of more than 256 triangles are left to chance.
                values[f"scene.materials.material{i}.emission.directlightsampling.type"] = "ENABLED"
            values[f"scene.objects.object{i}.shape"] = f"mesh{i}"
            values[f"scene.objects.object{i}.material"] = f"material{i}"
    scene.Parse(properties(values))
    return scene


# Its own radius and, every 8 samples, another set of photons with a smaller one.
CAUSTIC_CACHE = {
    "path.photongi.caustic.enabled": 1,
    "path.photongi.photon.maxcount": 4_000_000,
    "path.photongi.caustic.maxsize": 100_000,
    "path.photongi.caustic.updatespp": 8,
    "path.photongi.caustic.updatespp.radiusreduction": 0.96,
}


def render(
    scene: pyluxcore.Scene,
    size: tuple[int, int],
    depth: int,
    seed: int,
    halt: dict[str, float],
    more: dict[str, Any] | None = None,
) -> tuple[np.ndarray, float]:
    """(height, width, 3) and the seconds from the start to the last sample."""
    width, height = size
    values = {
        "renderengine.type": "PATHCPU",
        "renderengine.seed": seed + 1,
        "sampler.type": "SOBOL",
        "native.threads.count": THREADS,
        "film.width": width,
        "film.height": height,
        "film.filter.type": "BOX",
        "film.filter.width": 0.5,
        "path.pathdepth.total": depth - 1,
        "path.pathdepth.diffuse": depth - 1,
        "path.pathdepth.glossy": depth - 1,
        "path.pathdepth.specular": depth - 1,
        "path.clamping.variance.maxvalue": 0,
        "film.outputs.0.type": "RGB",
        "film.outputs.0.filename": "image.exr",
        **halt,
        **(more or {}),
    }
    session = pyluxcore.RenderSession(pyluxcore.RenderConfig(properties(values), scene))
    session.Start()
    start = time.perf_counter()
    while not session.HasDone():
        time.sleep(POLL_S)
        session.UpdateStats()
    seconds = time.perf_counter() - start
    pixels = np.empty((height, width, 3), np.float32)
    session.GetFilm().GetOutputFloat(pyluxcore.FilmOutputType.RGB, pixels)
    session.Stop()
    return pixels[::-1].copy(), seconds


def main() -> None:
    flat, size_text, depth, much, out, *caustics = sys.argv[1:]
    width, height = map(int, size_text.split("x"))
    size = (width, height)
    pyluxcore.Init(lambda message: None)
    scene = scene_of(flat, width, height)
    if caustics:
        halt = {"batch.halttime": float(much)}
        runs = [render(scene, size, int(depth), 0, halt, cache) for cache in (CAUSTIC_CACHE, {})]
        names, shape = ["LuxCore, PhotonGI", "LuxCore, path"], (2, 1)
    else:
        counts = enumerate(much.split(","))
        runs = [render(scene, size, int(depth), seed, {"batch.haltspp": int(spp)}) for seed, spp in counts]
        names, shape = ["LuxCore"], (1, len(runs))
    images = np.stack([image for image, _ in runs])
    seconds = np.array([s for _, s in runs])
    np.savez(out, names=names, images=images.reshape(*shape, *images.shape[1:]), seconds=seconds.reshape(shape))
    os._exit(0)  # its own end, with many lights, is now and then a segmentation fault


if __name__ == "__main__":
    main()
