"""Mitsuba 3's path tracer on a scene with each of its samplers, run by peers.py in a Python that has it.

mitsuba_peer.py SCENE SIDE DEPTH SPP,SPP,... OUT.npz
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
    scene_file, side, depth, counts, out = Path(sys.argv[1]), *sys.argv[2:]
    mi.set_variant("llvm_ad_rgb")
    dr.set_thread_count(THREADS)
    xml = re.sub(r'(name="filename" value=")', rf"\g<1>{scene_file.parent.resolve()}/", scene_file.read_text())
    xml = re.sub(r'(name="(?:width|height)" value=")[^"]*', rf"\g<1>{side}", xml)
    images, seconds = [], []
    for sampler in SAMPLERS:
        scene = mi.load_string(xml.replace("</film>", f'</film><sampler type="{sampler}"/>'), max_depth=depth)
        for seed, spp in enumerate(map(int, counts.split(","))):
            np.array(mi.render(scene, spp=spp, seed=99))  # compiles the kernels
            start = time.perf_counter()
            images.append(np.array(mi.render(scene, spp=spp, seed=seed))[..., :3])
            seconds.append(time.perf_counter() - start)
    shape = (len(SAMPLERS), len(counts.split(",")))
    names = [f"Mitsuba, {sampler}" for sampler in SAMPLERS]
    np.savez(
        out, names=names, images=np.stack(images).reshape(*shape, *images[0].shape), seconds=np.reshape(seconds, shape)
    )


if __name__ == "__main__":
    main()
