#include "io/read_sensor.h"

#include <cmath>

#include "io/properties.h"
#include "io/read_film.h"
#include "io/text.h"
#include "support/error.h"

namespace fluxfarm {
namespace {

constexpr NumberRange kInt32{-1, 2147483647};

CameraDescription::FovAxis read_fov_axis(Properties& properties) {
  const std::string axis = properties.text("fov_axis", "x");
  if (axis == "x") return CameraDescription::FovAxis::kX;
  if (axis == "y") return CameraDescription::FovAxis::kY;
  if (axis == "diagonal") return CameraDescription::FovAxis::kDiagonal;
  if (axis == "smaller") return CameraDescription::FovAxis::kSmaller;
  if (axis == "larger") return CameraDescription::FovAxis::kLarger;
  properties.fail("fov_axis", "expected x, y, diagonal, smaller or larger");
}

// The field of view along the diagonal of a 36 x 24 mm negative behind a lens of that focal length.
float fov_of_focal_length(Properties& properties) {
  std::string text = properties.text("focal_length", "50mm");
  if (text.size() > 2 && text.substr(text.size() - 2) == "mm") text.resize(text.size() - 2);
  const std::optional<double> millimetres = parse_number(text);
  if (!millimetres || !std::isfinite(*millimetres) || *millimetres <= 0) {
    properties.fail("focal_length", "expected a length greater than 0 in millimetres, as in \"50mm\"");
  }
  const double diagonal = std::sqrt(36.0 * 36.0 + 24.0 * 24.0);
  return static_cast<float>(2 * std::atan(diagonal / (2 * *millimetres)) * 180 / M_PI);
}

// A camera may be turned, moved and mirrored, not scaled.
Transform read_camera_frame(Properties& properties) {
  const Transform to_world = properties.transform("to_world");
  const auto& m = to_world.matrix();
  for (int a = 0; a < 3; ++a) {
    for (int b = 0; b <= a; ++b) {
      double product = 0;
      for (int row = 0; row < 3; ++row) product += m[row][a] * m[row][b];
      if (std::abs(product - (a == b ? 1 : 0)) > 2e-3) {
        properties.fail("to_world", "scales or shears the camera, expected a rotation and a translation");
      }
    }
  }
  return to_world;
}

CameraDescription read_camera(const std::string& type, Properties& properties) {
  CameraDescription camera;
  camera.to_world = read_camera_frame(properties);
  if (properties.has("fov") && properties.has("focal_length")) properties.fail("focal_length", "but fov is given, too");
  camera.fov_axis = read_fov_axis(properties);
  if (properties.has("fov")) {
    camera.fov_degrees = properties.number("fov", 0, {0, 180, true});
  } else {
    camera.fov_axis = CameraDescription::FovAxis::kDiagonal;
    camera.fov_degrees = fov_of_focal_length(properties);
  }
  camera.near_clip = properties.number("near_clip", 1e-2f, kPositive);
  camera.far_clip = properties.number("far_clip", 1e4f, kPositive);
  if (camera.far_clip <= camera.near_clip)
    properties.fail("far_clip", "expected more than near_clip = " + number_text(camera.near_clip));
  for (const char* name : {"principal_point_offset_x", "principal_point_offset_y"}) {
    if (properties.number(name, 0) != 0) properties.fail(name, "is not supported yet, expected 0");
  }
  if (type == "thinlens") {
    if (!properties.has("aperture_radius")) properties.fail("aperture_radius", "lacks the parameter \"aperture_radius\"");
    camera.aperture_radius = properties.number("aperture_radius", 0, kNotNegative);
    camera.focus_distance = properties.number("focus_distance", camera.far_clip, kPositive);
  }
  properties.ignore({"shutter_open", "shutter_close"});
  return camera;
}

// The engine always uses its own sampler; only the number of samples counts.
int read_sampler(const PluginNode& sampler) {
  check_no_children(sampler);
  Properties properties(sampler);
  const int samples = static_cast<int>(properties.integer("sample_count", 4, {1, 2147483647}));
  properties.ignore({"seed", "jitter", "scramble", "dimension"});
  properties.finish();
  return samples;
}

}  // namespace

void read_sensor(const PluginNode& sensor, MediumReader& media, SceneDescription& scene) {
  Properties properties(sensor);
  scene.camera = read_camera(sensor.type, properties);
  properties.finish();
  bool has_film = false, has_sampler = false, has_medium = false;
  for (const PluginNode& child : sensor.children) {
    const bool medium = child.kind == PluginKind::kMedium || child.kind == PluginKind::kReference;
    bool* seen = child.kind == PluginKind::kFilm      ? &has_film
                 : child.kind == PluginKind::kSampler ? &has_sampler
                 : medium                             ? &has_medium
                                                      : nullptr;
    if (!seen || *seen) fail_nested(sensor, child, "one film, one sampler and one medium");
    *seen = true;
    if (medium) {
      scene.camera.medium = media.read(child);
    } else if (child.kind == PluginKind::kFilm) {
      scene.film = read_film(child);
    } else {
      scene.samples_per_pixel = read_sampler(child);
    }
  }
  if (!has_film) scene.film = default_film();
}

MethodDescription read_integrator(const PluginNode& integrator) {
  check_no_children(integrator);
  Properties properties(integrator);
  MethodDescription method;
  // With or without media: whether there are any is seen in the scene.
  const bool photon = integrator.type == "photon", progressive = integrator.type == "photon-progressive";
  method.integrator = photon || progressive || integrator.type == "irradiance-cache" ? integrator.type : "path";
  method.max_depth = static_cast<int>(properties.integer("max_depth", -1, kInt32));
  method.rr_depth = static_cast<int>(properties.integer("rr_depth", 5, {1, 2147483647}));
  method.hide_emitters = properties.boolean("hide_emitters", false);
  if (photon || progressive) method.photons = static_cast<std::uint64_t>(properties.integer("photons", 0, {1, 1 << 28}));
  if (photon) method.final_gather = properties.boolean("final_gather", true);
  if (progressive) method.first_radius = properties.number("radius", method.first_radius, {1e-3, 1e3});
  if (integrator.type == "volpathmis") properties.ignore({"use_spectral_mis"});
  properties.finish();
  return method;
}

}  // namespace fluxfarm
