"""How the authored scenes of the benchmarks begin."""

HEAD = """<scene version="3.0.0">
  {integrator}
  <sensor type="perspective">
    <float name="fov" value="{fov}"/>
    <transform name="to_world"><lookat origin="{origin}" target="{target}" up="0, 1, 0"/></transform>
    <film type="hdrfilm">
      <integer name="width" value="256"/>
      <integer name="height" value="256"/>
      <rfilter type="box"/>
    </film>
  </sensor>
"""


def scene_head(integrator: str, fov: float, origin: str, target: str) -> str:
    """Mitsuba XML up to the camera; `fov` in degrees, `origin` and `target` in metres."""
    return HEAD.format(integrator=integrator, fov=fov, origin=origin, target=target)
