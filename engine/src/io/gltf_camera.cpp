#include "io/gltf_camera.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "io/limits.h"
#include "support/error.h"

namespace fluxfarm {
namespace {

constexpr double kDegrees = 180 / M_PI;

// Camera to world without the scale of the node, which glTF tells to ignore. glTF looks along -z with +x to the right; ours looks
// along +z with +x to the left.
Transform camera_frame(const GltfPlaced& placed) {
  Transform::Matrix m = placed.to_world.matrix();
  for (std::size_t column = 0; column < 3; ++column) {
    const double length = std::hypot(m[0][column], m[1][column], m[2][column]);
    const double sign = column == 1 ? 1 : -1;
    if (!(length > 0)) throw SceneError(placed.name, "the camera has a scale of 0, expected a frame");
    for (std::size_t row = 0; row < 3; ++row) m[row][column] *= sign / length;
  }
  for (std::size_t a = 0; a < 3; ++a) {
    const std::size_t b = (a + 1) % 3;
    if (std::abs(m[0][a] * m[0][b] + m[1][a] * m[1][b] + m[2][a] * m[2][b]) > 2e-3)
      throw SceneError(placed.name, "shears the camera, expected a rotation, a scale and a translation");
  }
  return Transform(m);
}

void set_film(double aspect, FilmDescription& film) {
  film.width = static_cast<int>(std::clamp(std::round(film.height * aspect), 1.0, static_cast<double>(kMaxImageSide)));
}

void use_camera(const GltfObject& camera, const GltfPlaced& placed, SceneDescription& scene) {
  const GltfObject perspective = camera.required_object("perspective");
  if (!perspective.has("yfov")) perspective.fail("yfov", "expected an angle in radians");
  if (!perspective.has("znear")) perspective.fail("znear", "expected a distance");
  CameraDescription& result = scene.camera;
  result.to_world = camera_frame(placed);
  result.fov_axis = CameraDescription::FovAxis::kY;
  result.fov_degrees = static_cast<float>(perspective.number("yfov", 0, {0, M_PI, true}) * kDegrees);
  result.near_clip = static_cast<float>(perspective.number("znear", 0, kPositive));
  // Without zfar the file means infinity.
  result.far_clip = static_cast<float>(perspective.number("zfar", 1e30, {static_cast<double>(result.near_clip), 1e30, true}));
  if (perspective.has("aspectRatio")) set_film(perspective.number("aspectRatio", 1, {1e-3, 1e3}), scene.film);
}

// From the front, a little from the right and above; the sphere around everything fills the smaller side of the film.
void frame_everything(const Bounds& bounds, CameraDescription& camera) {
  constexpr double kFov = 40, kMargin = 1.05;
  const Vec3f center = bounds.center();
  const double radius = std::max(static_cast<double>(bounds.radius()), 1e-6);
  const double distance = kMargin * radius / std::sin(0.5 * kFov / kDegrees);
  const std::array<double, 3> target{static_cast<double>(center.x), static_cast<double>(center.y), static_cast<double>(center.z)};
  const double length = std::hypot(0.4, 0.3, 1.0);
  const std::array<double, 3> origin{target[0] + distance * 0.4 / length, target[1] + distance * 0.3 / length,
                                     target[2] + distance * 1.0 / length};
  camera.to_world = Transform::look_at(origin, target, {0, 1, 0});
  camera.fov_axis = CameraDescription::FovAxis::kSmaller;
  camera.fov_degrees = static_cast<float>(kFov);
  camera.near_clip = static_cast<float>(1e-3 * distance);
  camera.far_clip = static_cast<float>(10 * distance);
}

}  // namespace

void read_gltf_camera(const GltfFile& file, const std::vector<GltfPlaced>& cameras, const Bounds& bounds, SceneDescription& scene) {
  const GltfPlaced* chosen = nullptr;
  for (const GltfPlaced& placed : cameras) {
    const GltfObject camera = file.at("cameras", placed.index);
    const std::string type = camera.text("type", "");
    if (type != "perspective" && type != "orthographic") camera.fail("type", "expected perspective or orthographic");
    if (type == "orthographic") {
      scene.warnings.push_back(placed.name + ": orthographic cameras are not read");
    } else if (chosen == nullptr) {
      chosen = &placed;
      use_camera(camera, placed, scene);
    } else {
      scene.warnings.push_back(placed.name + ": the file has more than one camera; that of " + chosen->name + " is used");
    }
  }
  if (chosen != nullptr) return;
  scene.warnings.push_back(file.name() + ": has no perspective camera; one that frames everything from the front is used");
  frame_everything(bounds, scene.camera);
}

}  // namespace fluxfarm
