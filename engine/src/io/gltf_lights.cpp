#include "io/gltf_lights.h"

#include <cmath>

#include "io/emission_limits.h"
#include "support/error.h"

namespace fluxfarm {
namespace {

Vec3f direction(const GltfPlaced& placed) {
  const Vec3f axis = placed.to_world.vector({0, 0, -1});
  const float longest = std::max({std::abs(axis.x), std::abs(axis.y), std::abs(axis.z)});
  if (!(longest > 0) || !std::isfinite(longest))
    throw SceneError(placed.name, "the light points nowhere: its -z axis has no length");
  return normalize(axis / longest);
}

}  // namespace

EmitterDescription read_gltf_light(const GltfFile& file, const GltfPlaced& placed) {
  const GltfObject light = file.root().extension("KHR_lights_punctual")->objects("lights").at(placed.index);
  const std::vector<double> color = light.numbers("color", 3, {1, 1, 1}, kNotNegative);
  const double intensity = light.number("intensity", 1, kNotNegative);
  const Rgb radiometric{static_cast<float>(color[0] * intensity), static_cast<float>(color[1] * intensity),
                        static_cast<float>(color[2] * intensity)};
  if (!is_within_emission_limits(radiometric)) light.fail("intensity", std::string(kEmissionExpected) + ", with color");
  const std::string type = light.text("type", "");
  if (type == "directional") return DirectionalEmitterDescription{direction(placed), radiometric};
  const Vec3f position = placed.to_world.point({0, 0, 0});
  if (!is_finite(position)) throw SceneError(placed.name, "the place of the light is not finite");
  if (type == "point") return PointEmitterDescription{position, radiometric};
  if (type != "spot") light.fail("type", "expected point, spot or directional");
  const GltfObject spot = light.required_object("spot");
  const double outer = spot.number("outerConeAngle", M_PI / 4, {0, M_PI / 2});
  const double inner = spot.number("innerConeAngle", 0, kNotNegative);
  if (!(inner < outer)) spot.fail("innerConeAngle", "expected less than outerConeAngle, which is " + std::to_string(outer));
  SpotEmitterDescription result{position, direction(placed), radiometric, 0, 0};
  result.cutoff_angle_degrees = static_cast<float>(outer * 180 / M_PI);
  result.beam_width_degrees = std::min(static_cast<float>(inner * 180 / M_PI), result.cutoff_angle_degrees);
  return result;
}

}  // namespace fluxfarm
