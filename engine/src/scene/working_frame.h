// The frame in which a scene is rendered: rays leave surfaces by a few hundred times the rounding of their coordinates, 1.5e-5 m at
// least (math/ray.h), which has to be little against the scene. A scene far from the origin is moved there, a small one enlarged.
//
// Pictures do not change: radiance does not depend on either, the intensity of points is enlarged by the square, and depths are
// told in metres. Large scenes stay as they are, for the place that the camera sees may be small; a warning tells of places too
// small for that, as far as the camera's near plane says so.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "scene/description.h"

namespace fluxfarm {

// A description in its working frame. Keeps a reference to `description`, which has to outlive it, unless it has to differ.
// Throws SceneError for a scene that is too small to be enlarged.
class WorkingDescription {
 public:
  explicit WorkingDescription(const SceneDescription& description);

  const SceneDescription& get() const { return changed_ ? *changed_ : original_; }
  // What is wrong in the picture all the same.
  const std::vector<std::string>& warnings() const { return warnings_; }

 private:
  const SceneDescription& original_;
  std::optional<SceneDescription> changed_;
  std::vector<std::string> warnings_;
};

}  // namespace fluxfarm
