"""What both renderers are given of an outside scene where they could not agree on the authored one: text to text.

glass-of-milk:
- The foot of the glass lies in the plane of the table, and which of the two a ray meets is a matter of rounding; the
  table goes down by 1 cm.
- The table's `blendbsdf` becomes a diffuse one. Mitsuba 3.6.4 weighs a sampled direction by the density of the chosen
  part and a sampled light by that of both, so that the weights do not add up to one (a plate of this blend under a
  lamp: 0.0833 by its path tracer, 0.0622 by sampling either the lamp alone or the plate alone).
- The scene names no depth: 17 for both, so that the milk's long walks end alike.
"""

import re

TABLE = '<string name="filename" value="meshes/table_top.obj"/>'
LOWERED = TABLE + '<transform name="toWorld"><translate z="-0.01"/></transform>'
BLEND = re.compile(r'<bsdf type="blendbsdf">.*?</bsdf>\s*</bsdf>', re.S)
WOOD = '<bsdf type="diffuse"><rgb name="reflectance" value="0.5 0.3 0.2"/></bsdf>'
HEAD = '<scene version="0.6.0">'
DEPTH_17 = '<integrator type="volpath"><integer name="maxDepth" value="17"/></integrator>'


def as_compared(name: str, xml: str) -> str:
    """The scene file `xml` of the folder `name`, changed where it has to be."""
    if name != "glass-of-milk":
        return xml
    for part in (TABLE, HEAD):
        assert xml.count(part) == 1, f"glass-of-milk is not the scene that we know: {part}"
    assert len(BLEND.findall(xml)) == 1, "glass-of-milk is not the scene that we know: no blendbsdf"
    return BLEND.sub(WOOD, xml).replace(TABLE, LOWERED).replace(HEAD, HEAD + DEPTH_17)
