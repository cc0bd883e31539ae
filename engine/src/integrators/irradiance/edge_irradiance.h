// What an edge adds to the irradiance of a polygon of even radiance, with its first and second derivatives.
//
// [Lambert60] The irradiance of a polygon of radiance one, wholly above the horizon, is half the sum over its edges, taken
// counter-clockwise as seen from above, of n . (v1 x v2) times the integral over the edge of 1 / |v(s)|^2, s in [0,1]: the angle
// that the edge spans times the unit normal of the plane through it and the receiver.
//
// v(s) = v1 + s (v2 - v1) leads from the receiver to the edge, so that a step of the receiver moves it the other way: with
// e = v2 - v1, a = e x n and c = v1 x v2, which is v(s) x e for all s,
//   gradient_i  = -a_i integral(1 / v^2) + 2 (n . c) integral(v_i / v^4)
//   hessian_ij  = -2 integral((a_i v_j + a_j v_i) / v^4) + 2 (n . c) integral(4 v_i v_j / v^6 - delta_ij / v^4).
// A scene of which only the radiances and distances of a grid of directions are known is taken for a mesh between them: its edges
// hold what comes into sight and what goes out of sight as the receiver moves. [Schwarzhaupt12]
//
// [Schwarzhaupt12] J. Schwarzhaupt, H. W. Jensen, W. Jarosz, "Practical Hessian-Based Error Control for Irradiance Caching",
// ACM TOG 31(6), 2012. The formulas here are our own.
#pragma once

#include <cmath>

#include "math/vec.h"

namespace fluxfarm {

// A symmetric 2 x 2 matrix over the receiver's tangent plane.
struct TangentMatrix {
  double xx = 0, xy = 0, yy = 0;

  double along(double x, double y) const { return xx * x * x + 2 * xy * x * y + yy * y * y; }
};

// In the receiver's frame, z along its normal. Derivatives are over its place in the tangent plane, m^-1 and m^-2.
struct EdgeIrradiance {
  double value = 0;
  double gradient_x = 0, gradient_y = 0;
  TangentMatrix hessian;
};

// `v1`, `v2`: ends of the edge, from the receiver, m. Zero for an edge on a line through the receiver, which has no part in it.
inline EdgeIrradiance edge_irradiance(Vec3f v1, Vec3f v2) {
  struct Vector {
    double x, y, z;
  };
  const Vector a{static_cast<double>(v1.x), static_cast<double>(v1.y), static_cast<double>(v1.z)};
  const Vector e{static_cast<double>(v2.x) - a.x, static_cast<double>(v2.y) - a.y, static_cast<double>(v2.z) - a.z};
  const Vector c{a.y * e.z - a.z * e.y, a.z * e.x - a.x * e.z, a.x * e.y - a.y * e.x};
  const double edge_squared = e.x * e.x + e.y * e.y + e.z * e.z;
  const double area_squared = c.x * c.x + c.y * c.y + c.z * c.z;
  const double far_squared = a.x * a.x + a.y * a.y + a.z * a.z + edge_squared;
  if (!(area_squared > 1e-16 * far_squared * edge_squared)) return {};
  const double edge = std::sqrt(edge_squared), per_edge = 1 / edge;
  const Vector u{e.x * per_edge, e.y * per_edge, e.z * per_edge};
  // v = foot + t u, t from t1 to t2; `foot` is the point of the line next to the receiver, at distance h.
  const double t1 = a.x * u.x + a.y * u.y + a.z * u.z, t2 = t1 + edge;
  const Vector foot{a.x - t1 * u.x, a.y - t1 * u.y, a.z - t1 * u.z};
  const double h2 = area_squared / edge_squared, h = std::sqrt(h2);
  const double q1 = 1 / (h2 + t1 * t1), q2 = 1 / (h2 + t2 * t2);
  // Integrals over the edge of t^k / v^n.
  const double angle = std::atan2(h * edge, h2 + t1 * t2);
  const double i2 = per_edge * angle / h;
  const double i4 = per_edge * ((t2 * q2 - t1 * q1) / (2 * h2) + angle / (2 * h2 * h));
  const double i4t = per_edge * (q1 - q2) / 2;
  const double i6 = per_edge * ((t2 * q2 * q2 - t1 * q1 * q1) / (4 * h2) + 3 * (t2 * q2 - t1 * q1) / (8 * h2 * h2) +
                                3 * angle / (8 * h2 * h2 * h));
  const double i6t = per_edge * (q1 * q1 - q2 * q2) / 4;
  const double i6tt = i4 - h2 * i6;

  const double ax = e.y, ay = -e.x;
  const double jx = foot.x * i4 + u.x * i4t, jy = foot.y * i4 + u.y * i4t;
  const auto k = [&](double foot_i, double u_i, double foot_j, double u_j) {
    return foot_i * foot_j * i6 + (foot_i * u_j + u_i * foot_j) * i6t + u_i * u_j * i6tt;
  };
  EdgeIrradiance result;
  result.value = c.z * i2 / 2;
  result.gradient_x = (-ax * i2 + 2 * c.z * jx) / 2;
  result.gradient_y = (-ay * i2 + 2 * c.z * jy) / 2;
  result.hessian.xx = -2 * ax * jx + c.z * (4 * k(foot.x, u.x, foot.x, u.x) - i4);
  result.hessian.yy = -2 * ay * jy + c.z * (4 * k(foot.y, u.y, foot.y, u.y) - i4);
  result.hessian.xy = -(ax * jy + ay * jx) + c.z * 4 * k(foot.x, u.x, foot.y, u.y);
  return result;
}

}  // namespace fluxfarm
