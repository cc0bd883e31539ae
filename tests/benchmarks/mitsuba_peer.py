"""Mitsuba 3's path tracer on a scene, run by bench.py in another Python: mitsuba_peer.py SCENE SIDE SPP OUT."""

import re
import sys
import time
from pathlib import Path

import drjit as dr
import mitsuba as mi
import numpy as np

SEEDS = 3


def main() -> None:
    scene_file, side, spp, out = Path(sys.argv[1]), int(sys.argv[2]), int(sys.argv[3]), sys.argv[4]
    mi.set_variant("llvm_ad_rgb")
    dr.set_thread_count(2)
    folder = f"{scene_file.parent.resolve()}/"
    xml = re.sub(r'(name="filename" value=")', rf"\g<1>{folder}", scene_file.read_text())
    xml = xml.replace("</film>", '<boolean name="sample_border" value="true"/></film>')
    xml = re.sub(r'(name="(?:width|height)" value=")[^"]*', rf"\g<1>{side}", xml)
    results = {}
    for sampler in ("independent", "multijitter"):
        chosen = f'<sampler type="{sampler}"'
        text = xml.replace('<sampler type="independent"', chosen)
        if "<sampler" not in text:
            text = text.replace("</film>", f"</film>{chosen}/>")
        scene = mi.load_string(text)
        np.array(mi.render(scene, spp=spp, seed=99))  # compiles the kernels
        images, seconds = [], []
        for seed in range(SEEDS):
            start = time.perf_counter()
            images.append(np.array(mi.render(scene, spp=spp, seed=seed))[..., :3].astype(np.float64))
            seconds.append(time.perf_counter() - start)
        results[f"{sampler}_images"], results[f"{sampler}_seconds"] = np.stack(images), np.array(seconds)
    np.savez(out, **results)


if __name__ == "__main__":
    main()
