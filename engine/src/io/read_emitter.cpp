#include "io/read_emitter.h"

#include <algorithm>
#include <cmath>

#include "io/emission_limits.h"
#include "io/envmap_image.h"
#include "io/properties.h"
#include "io/text.h"
#include "io/transform_checks.h"
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

// The place and direction of a light may be turned, moved, mirrored and enlarged; another transform would bend its shape.
Transform read_light_frame(Properties& properties) {
  const Transform to_world = properties.transform("to_world");
  if (!keeps_shape(to_world, 3))
    properties.fail("to_world", "stretches or shears the light, expected the same scale, not 0, on all axes");
  return to_world;
}

SpotEmitterDescription read_spot_emitter(Properties& properties) {
  SpotEmitterDescription result;
  const Transform to_world = read_light_frame(properties);
  result.position = to_world.point({0, 0, 0});
  if (!is_finite(result.position)) properties.fail("to_world", "expected finite numbers");
  result.axis = normalize(to_world.vector({0, 0, 1}));
  result.intensity = properties.emission("intensity", Rgb(1));
  result.cutoff_angle_degrees = properties.number("cutoff_angle", 20, {0, 180, true});
  const float cutoff = result.cutoff_angle_degrees;
  result.beam_width_degrees = properties.number("beam_width", 0.75f * cutoff, {0, static_cast<double>(cutoff)});
  return result;
}

DirectionalEmitterDescription read_directional_emitter(Properties& properties) {
  DirectionalEmitterDescription result;
  if (properties.has("direction") && properties.has("to_world")) properties.fail("direction", "but to_world is given, too");
  if (properties.has("direction")) {
    const auto [x, y, z] = properties.triple("direction", {});
    const double length = std::hypot(x, y, z);
    if (!std::isfinite(length) || !(length > 0)) properties.fail("direction", "expected a direction other than 0, 0, 0");
    result.direction = {static_cast<float>(x / length), static_cast<float>(y / length), static_cast<float>(z / length)};
  } else {
    result.direction = normalize(read_light_frame(properties).vector({0, 0, 1}));
  }
  result.irradiance = properties.emission("irradiance", Rgb(1));
  return result;
}

EnvmapEmitterDescription read_envmap_emitter(const PluginNode& emitter, Properties& properties, const Bundle& bundle) {
  EnvmapEmitterDescription result;
  result.to_world = read_light_frame(properties);
  const float scale = properties.number("scale", 1, kNotNegative);
  properties.ignore({"mis_compensation"});
  if (!properties.has("filename")) properties.fail("filename", "lacks the parameter \"filename\"");
  const std::filesystem::path file = bundle.find(properties.text("filename", ""), emitter.place);
  properties.finish();  // before the image, which may be large
  result.image = read_envmap_image(file, bundle.name(file));
  float brightest = 0;
  for (Rgb& pixel : result.image.pixels) {
    pixel *= scale;
    if (!is_finite(pixel)) properties.fail("scale", "makes the image's radiance infinite, expected a smaller number");
    brightest = std::max(brightest, max_component(pixel));
  }
  if (!is_within_emission_limits(Rgb{brightest})) {
    properties.fail("scale", "makes the brightest pixel " + number_text(static_cast<double>(brightest)) + ", " + kEmissionExpected);
  }
  return result;
}

}  // namespace

EmitterDescription read_scene_emitter(const PluginNode& emitter, const Bundle& bundle) {
  if (emitter.type == "area") throw SceneError(emitter.place, title(emitter) + " stands by itself, expected it inside a shape");
  check_no_children(emitter);
  Properties properties(emitter);
  EmitterDescription result;
  if (emitter.type == "point") {
    result = read_point_emitter(properties);
  } else if (emitter.type == "spot") {
    result = read_spot_emitter(properties);
  } else if (emitter.type == "directional") {
    result = read_directional_emitter(properties);
  } else if (emitter.type == "envmap") {
    result = read_envmap_emitter(emitter, properties, bundle);
  } else {
    properties.ignore({"to_world"});  // the same from every direction
    result = ConstantEmitterDescription{properties.emission("radiance", Rgb(1))};
  }
  properties.finish();
  return result;
}

}  // namespace fluxfarm
