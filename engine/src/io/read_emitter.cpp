#include "io/read_emitter.h"

#include <cmath>

#include "io/properties.h"
#include "support/error.h"

namespace fluxfarm {

Rgb read_area_emitter(const PluginNode& emitter, const PluginNode& shape) {
  if (emitter.type != "area") {
    throw SceneError(emitter.place, title(emitter) + " stands inside a " + title(shape) + ", expected it directly in the scene");
  }
  check_no_children(emitter);
  Properties properties(emitter);
  const Rgb radiance = properties.emission("radiance", Rgb(1));
  properties.finish();
  return radiance;
}

namespace {

PointEmitterDescription read_point_emitter(Properties& properties) {
  PointEmitterDescription result;
  if (properties.has("position") && properties.has("to_world")) properties.fail("position", "but to_world is given, too");
  const Triple p = properties.triple("position", {0, 0, 0});
  result.position = {static_cast<float>(p[0]), static_cast<float>(p[1]), static_cast<float>(p[2])};
  if (properties.has("to_world")) result.position = properties.transform("to_world").point({0, 0, 0});
  if (!is_finite(result.position)) properties.fail("position", "expected finite numbers");
  result.intensity = properties.emission("intensity", Rgb(1));
  return result;
}

}  // namespace

EmitterDescription read_scene_emitter(const PluginNode& emitter) {
  if (emitter.type == "area") throw SceneError(emitter.place, title(emitter) + " stands by itself, expected it inside a shape");
  check_no_children(emitter);
  Properties properties(emitter);
  EmitterDescription result;
  if (emitter.type == "point") {
    result = read_point_emitter(properties);
  } else {
    properties.ignore({"to_world"});  // the same from every direction
    result = ConstantEmitterDescription{properties.emission("radiance", Rgb(1))};
  }
  properties.finish();
  return result;
}

}  // namespace fluxfarm
