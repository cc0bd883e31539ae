"""Mitsuba 3's path tracer on a scene with each of its samplers or one of them, in a Python that has it.

mitsuba_peer.py SCENE WIDTHxHEIGHT DEPTH SPP,SPP,... OUT.npz [SAMPLER]
"""

import re
import sys
import time
from pathlib import Path

import drjit as dr
import mitsuba as mi
import numpy as np

THREADS = 2
SAMPLERS = ("independent", "stratified", "multijitter", "orthogonal", "ldsampler")


def main() -> None:
    scene_file, (size, depth, counts, out, *only) = Path(sys.argv[1]), sys.argv[2:]
    width, height = size.split("x")
    samplers = only or SAMPLERS
    mi.set_variant("llvm_ad_rgb")
    dr.set_thread_count(THREADS)
    xml = re.sub(r'(name="filename" value=")', rf"\g<1>{scene_file.parent.resolve()}/", scene_file.read_text())
    for name, value in (("width", width), ("height", height), ("max_depth", depth)):
        xml = re.sub(rf'(name="{name}" value=")[^"]*', rf"\g<1>{value}", xml)
    if "<integrator" not in xml:
        integrator = f'<integrator type="volpath"><integer name="max_depth" value="{depth}"/></integrator>'
        xml = xml.replace("<sensor", integrator + "<sensor", 1)
    images, seconds = [], []
    for sampler in samplers:
        scene = mi.load_string(xml.replace("</film>", f'</film><sampler type="{sampler}"/>'))
        for seed, spp in enumerate(map(int, counts.split(","))):
            np.array(mi.render(scene, spp=spp, seed=99))  # compiles the kernels
            start = time.perf_counter()
            images.append(np.array(mi.render(scene, spp=spp, seed=seed))[..., :3])
            seconds.append(time.perf_counter() - start)
    shape = (len(samplers), len(counts.split(",")))
    names = [f"Mitsuba, {sampler}" for sampler in samplers]
    np.savez(
        out, names=names, images=np.stack(images).reshape(*shape, *images[0].shape), seconds=np.reshape(seconds, shape)
    )


if __name__ == "__main__":
    main()
