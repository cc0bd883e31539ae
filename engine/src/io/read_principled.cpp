#include "io/read_principled.h"

#include <cmath>

#include "io/material_parameters.h"

namespace fluxfarm {
namespace {

// Given as such or by `specular`, the reflectance at normal incidence over 0.08.
float read_eta(Properties& properties, bool transmits) {
  if (properties.has("eta")) {
    if (properties.has("specular")) properties.fail("specular", "but eta is given, too; expected one or the other");
    return properties.number("eta", 1.5f, kPositive);
  }
  float specular = properties.number("specular", 0.5f, kUnitInterval);
  if (transmits && specular == 0) specular = 1e-3f;  // as Mitsuba does
  return 2 / (1 - std::sqrt(0.08f * specular)) - 1;
}

}  // namespace

PrincipledDescription read_principled(Properties& properties, TextureReader& textures) {
  PrincipledDescription d;
  const auto scalar = [&](const char* name, float otherwise) { return read_scalar(properties, textures, name, otherwise); };
  d.base_color = read_colour(properties, textures, "base_color", Rgb(0.5f), d.base_color_texture);
  d.roughness = scalar("roughness", 0.5f);
  d.anisotropic = scalar("anisotropic", 0);
  d.metallic = scalar("metallic", 0);
  d.spec_trans = scalar("spec_trans", 0);
  d.spec_tint = scalar("spec_tint", 0);
  d.sheen = scalar("sheen", 0);
  d.sheen_tint = scalar("sheen_tint", 0);
  d.flatness = scalar("flatness", 0);
  d.clearcoat = scalar("clearcoat", 0);
  d.clearcoat_gloss = scalar("clearcoat_gloss", 0);
  d.eta = read_eta(properties, d.spec_trans.factor > 0);
  properties.ignore({"diffuse_reflectance_sampling_rate", "main_specular_sampling_rate", "clearcoat_sampling_rate"});
  return d;
}

}  // namespace fluxfarm
