// Scenes that the tests of the light-side audit share.
#pragma once

#include <utility>

#include "film/pixel_rect.h"
#include "support/scene_builder.h"

namespace fluxfarm::testing {

inline constexpr int kSide = 64;
inline constexpr PixelRect kFrame{0, 0, kSide, kSide};

// The builder's scene seen by a camera with a wide view of four cells.
inline SceneDescription wide_view(const SceneBuilder& builder, float fov_degrees) {
  SceneDescription scene = builder.description();
  scene.camera.fov_degrees = fov_degrees;
  scene.film.width = scene.film.height = kSide;
  return scene;
}

// A closed room with a lamp under its ceiling, and a ball of that material on its floor.
inline SceneBuilder room(MaterialDescription block, float walls = 0.7f) {
  SceneBuilder builder;
  const int wall = builder.diffuse(walls);
  builder.shape(cube(Transform::scale(1, 1, 1)), wall, 0, true);
  builder.lamp_down(0, 0.99f, 0.6f, 0.5f, 0.5f, builder.diffuse(0), 5);
  builder.shape(SphereDescription{{-0.1f, -0.6f, -0.4f}, 0.35f}, builder.add(std::move(block)));
  builder.look({0.2, -0.2, 0.9}, {0, -0.6, -0.6});
  return builder;
}

}  // namespace fluxfarm::testing
