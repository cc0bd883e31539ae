// Builds small scenes in code and measures the radiance at one point of them, with its standard error.
#pragma once

#include <atomic>
#include <cmath>
#include <vector>

#include "integrators/integrator.h"
#include "scene/description.h"
#include "worker/frame_renderer.h"

namespace fluxfarm::testing {

inline const std::atomic<bool> kNever{false};  // cancelled

// Closed mesh of 12 triangles: the image of [-1,1]^3, front side outwards.
inline MeshDescription cube(const Transform& to_world) {
  MeshDescription mesh;
  for (int i = 0; i < 8; ++i)
    mesh.positions.push_back(to_world.point({i & 1 ? 1.0f : -1.0f, i & 2 ? 1.0f : -1.0f, i & 4 ? 1.0f : -1.0f}));
  mesh.indices = {0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6, 0, 1, 5, 0, 5, 4, 2, 6, 7, 2, 7, 3, 0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5};
  return mesh;
}

class SceneBuilder {
 public:
  SceneBuilder() {
    description_.film.filter.kind = PixelFilterKind::kBox;
    description_.camera.near_clip = 1e-3f;
  }

  int diffuse(float reflectance) { return add(DiffuseDescription{Rgb{reflectance}}); }
  int add(MaterialDescription material) {
    description_.materials.push_back(material);
    return static_cast<int>(description_.materials.size()) - 1;
  }

  int texture(TextureDescription texture) {
    description_.textures.push_back(texture);
    return static_cast<int>(description_.textures.size()) - 1;
  }

  // A shape of that geometry; `radiance` above zero makes its front side emit.
  template <typename Geometry>
  SceneBuilder& shape(Geometry geometry, int material, float radiance = 0, bool flip_normals = false) {
    ShapeDescription shape;
    shape.name = "test shape";
    shape.geometry = geometry;
    shape.flip_normals = flip_normals;
    shape.material = material;
    if (radiance > 0) shape.emitted_radiance = Rgb{radiance};
    description_.shapes.push_back(shape);
    return *this;
  }
  // Square of half side `half` at height y with its normal up.
  SceneBuilder& floor(float y, float half, int material) {
    return shape(RectangleDescription{Transform::translate(0, static_cast<double>(y), 0) * Transform::rotate(1, 0, 0, -90) *
                                      Transform::scale(static_cast<double>(half), static_cast<double>(half), 1)},
                 material);
  }
  // Rectangle of size a x b with its centre there, facing down.
  SceneBuilder& lamp_down(float x, float y, float z, float a, float b, int material, float radiance) {
    return shape(RectangleDescription{Transform::translate(static_cast<double>(x), static_cast<double>(y), static_cast<double>(z)) *
                                      Transform::rotate(1, 0, 0, 90) *
                                      Transform::scale(static_cast<double>(a) / 2, static_cast<double>(b) / 2, 1)},
                 material, radiance);
  }
  SceneBuilder& emitter(EmitterDescription emitter) {
    description_.emitters.push_back(emitter);
    return *this;
  }
  // The camera sees one point: a few pixels within a hundredth of a degree.
  SceneBuilder& look(const std::array<double, 3>& from, const std::array<double, 3>& at) {
    const bool vertical = from[0] == at[0] && from[2] == at[2];
    description_.camera.to_world =
        Transform::look_at(from, at, vertical ? std::array<double, 3>{0, 0, 1} : std::array<double, 3>{0, 1, 0});
    description_.camera.fov_degrees = 0.01f;
    description_.film.width = description_.film.height = 4;
    return *this;
  }
  // Index of a new medium.
  int medium(const HomogeneousMediumDescription& medium) {
    description_.media.push_back(medium);
    return static_cast<int>(description_.media.size()) - 1;
  }
  // Fills what lies behind the last shape.
  SceneBuilder& interior(int medium) {
    description_.shapes.back().interior_medium = medium;
    return *this;
  }
  // What lies before it.
  SceneBuilder& exterior(int medium) {
    description_.shapes.back().exterior_medium = medium;
    return *this;
  }
  // The camera stands in it.
  SceneBuilder& camera_in(int medium) {
    description_.camera.medium = medium;
    return *this;
  }
  SceneBuilder& near_clip(float distance) {
    description_.camera.near_clip = distance;
    return *this;
  }
  SceneBuilder& max_depth(int depth) {
    description_.method.max_depth = depth;
    return *this;
  }
  const SceneDescription& description() const { return description_; }

 private:
  SceneDescription description_;
};

// Mean radiance over the frame (green channel: the scenes are grey) and its standard error, from the replicates of every pixel,
// which are independent of each other.
struct Measurement {
  double mean = 0, standard_error = 0;

  double z(double expected) const {
    const double difference = std::abs(mean - expected);
    return difference <= 1e-6 * std::abs(expected) ? 0.0 : difference / standard_error;  // float rounding is no error
  }
};

inline Measurement measure(const SceneDescription& description, std::uint32_t spp, std::uint64_t seed = 1) {
  const Scene scene(description, 1);
  const auto integrator = make_integrator("path", scene);
  const PixelRect frame{0, 0, description.film.width, description.film.height};
  const FrameResult result = render_frame(scene, *integrator, {frame, 64, 1, seed, {spp, {}, {}}}, kNever);
  std::vector<double> values;
  for (int y = 0; y < frame.height; ++y) {
    for (int x = 0; x < frame.width; ++x) {
      for (std::uint32_t r = 0; r < kFilmReplicates; ++r)
        values.push_back(static_cast<double>(result.film.replicate_mean(x, y, r).g));
    }
  }
  Measurement m;
  for (const double v : values) m.mean += v / static_cast<double>(values.size());
  double squares = 0;
  for (const double v : values) squares += (v - m.mean) * (v - m.mean);
  const double n = static_cast<double>(values.size());
  m.standard_error = std::sqrt(squares / (n * (n - 1)));
  return m;
}

}  // namespace fluxfarm::testing
