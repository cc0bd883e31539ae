#include "io/transform_steps.h"

#include "io/text.h"
#include "support/error.h"

namespace fluxfarm {

Transform matrix_step(const std::vector<double>& values, const std::string& place) {
  if (values.size() != 9 && values.size() != 16) {
    throw SceneError(place, "a matrix has " + std::to_string(values.size()) + " numbers, expected 16 or 9");
  }
  const std::size_t side = values.size() == 16 ? 4 : 3;
  Transform::Matrix m{{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}}};
  for (std::size_t i = 0; i < values.size(); ++i) m[i / side][i % side] = values[i];
  if (m[3][0] != 0 || m[3][1] != 0 || m[3][2] != 0 || m[3][3] == 0) {
    throw SceneError(place, "the last row of a matrix is " + number_text(m[3][0]) + " " + number_text(m[3][1]) + " " +
                                number_text(m[3][2]) + " " + number_text(m[3][3]) + ", expected 0 0 0 1");
  }
  const double w = m[3][3];
  for (auto& row : m) {
    for (double& value : row) value /= w;
  }
  return Transform(m);
}

Transform rotate_step(const Triple& axis, double angle_degrees, const std::string& place) {
  if (axis == Triple{0, 0, 0}) throw SceneError(place, "the axis of a rotation is 0 0 0, expected a direction");
  return Transform::rotate(axis[0], axis[1], axis[2], angle_degrees);
}

Transform look_at_step(const Triple& origin, const Triple& target, const Triple& up, const std::string& place) {
  const Transform result = Transform::look_at(origin, target, up);
  if (!result.is_finite()) {
    throw SceneError(place, "lookat gives no direction: target equals origin, or up points along the view");
  }
  return result;
}

}  // namespace fluxfarm
