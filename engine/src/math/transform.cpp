#include "math/transform.h"

#include <cmath>

namespace fluxfarm {
namespace {

using Triple = std::array<double, 3>;

Triple subtract(const Triple& a, const Triple& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }

Triple cross(const Triple& a, const Triple& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

Triple normalized(const Triple& a) {
  const double length = std::sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]);
  return {a[0] / length, a[1] / length, a[2] / length};
}

}  // namespace

Transform::Transform() : m_{{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}}} {}

Transform Transform::translate(double x, double y, double z) {
  return Transform({{{1, 0, 0, x}, {0, 1, 0, y}, {0, 0, 1, z}, {0, 0, 0, 1}}});
}

Transform Transform::scale(double x, double y, double z) {
  return Transform({{{x, 0, 0, 0}, {0, y, 0, 0}, {0, 0, z, 0}, {0, 0, 0, 1}}});
}

Transform Transform::rotate(double x, double y, double z, double angle_degrees) {
  // Rodrigues' rotation formula as a matrix.
  const auto [ax, ay, az] = normalized({x, y, z});
  const double angle = angle_degrees * M_PI / 180;
  const double c = std::cos(angle), s = std::sin(angle), k = 1 - c;
  return Transform({{{c + k * ax * ax, k * ax * ay - s * az, k * ax * az + s * ay, 0},
                     {k * ay * ax + s * az, c + k * ay * ay, k * ay * az - s * ax, 0},
                     {k * az * ax - s * ay, k * az * ay + s * ax, c + k * az * az, 0},
                     {0, 0, 0, 1}}});
}

Transform Transform::look_at(const Triple& origin, const Triple& target, const Triple& up) {
  const Triple z = normalized(subtract(target, origin));
  const Triple x = normalized(cross(up, z));
  const Triple y = cross(z, x);
  return Transform({{{x[0], y[0], z[0], origin[0]}, {x[1], y[1], z[1], origin[1]}, {x[2], y[2], z[2], origin[2]}, {0, 0, 0, 1}}});
}

Transform Transform::operator*(const Transform& first) const {
  Matrix product{};
  for (int row = 0; row < 4; ++row) {
    for (int column = 0; column < 4; ++column) {
      for (int k = 0; k < 4; ++k) product[row][column] += m_[row][k] * first.m_[k][column];
    }
  }
  return Transform(product);
}

Vec3f Transform::point(Vec3f p) const {
  const auto row = [&](int i) { return static_cast<float>(m_[i][0] * p.x + m_[i][1] * p.y + m_[i][2] * p.z + m_[i][3]); };
  return {row(0), row(1), row(2)};
}

Vec3f Transform::vector(Vec3f v) const {
  const auto row = [&](int i) { return static_cast<float>(m_[i][0] * v.x + m_[i][1] * v.y + m_[i][2] * v.z); };
  return {row(0), row(1), row(2)};
}

Vec3f Transform::normal(Vec3f n) const {
  // Columns of the linear part; the cofactor matrix has their cross products as columns.
  const Triple a{m_[0][0], m_[1][0], m_[2][0]}, b{m_[0][1], m_[1][1], m_[2][1]}, c{m_[0][2], m_[1][2], m_[2][2]};
  const Triple bc = cross(b, c), ca = cross(c, a), ab = cross(a, b);
  const double side = determinant() < 0 ? -1 : 1;
  const auto row = [&](int i) { return static_cast<float>(side * (bc[i] * n.x + ca[i] * n.y + ab[i] * n.z)); };
  return {row(0), row(1), row(2)};
}

double Transform::determinant() const {
  return m_[0][0] * (m_[1][1] * m_[2][2] - m_[1][2] * m_[2][1]) - m_[0][1] * (m_[1][0] * m_[2][2] - m_[1][2] * m_[2][0]) +
         m_[0][2] * (m_[1][0] * m_[2][1] - m_[1][1] * m_[2][0]);
}

bool Transform::is_finite() const {
  for (const auto& row : m_) {
    for (const double value : row) {
      if (!std::isfinite(value)) return false;
    }
  }
  return true;
}

}  // namespace fluxfarm
