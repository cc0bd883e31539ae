// Second derivatives of the irradiance of surfaces that all shine alike, against differences and in rooms where they are known.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "geometric_hessian.h"
#include "integrators/irradiance/hemisphere_grid.h"
#include "sampling/warp.h"

namespace fluxfarm::ablation {
namespace {

struct Patch {
  double x, y, z;
  double mx, my, mz;  // its normal

  // What it sends to a receiver at (at_x, at_y, 0) that looks up.
  double sent(double at_x, double at_y) const {
    const double vx = x - at_x, vy = y - at_y, squared = vx * vx + vy * vy + z * z;
    return z * -(mx * vx + my * vy + mz * z) / (squared * squared);
  }
  TangentMatrix hessian() const {
    const double distance = std::sqrt(x * x + y * y + z * z);
    const auto f = [](double a) { return static_cast<float>(a); };
    return patch_hessian({f(x / distance), f(y / distance), f(z / distance)}, f(distance), {f(mx), f(my), f(mz)});
  }
};

TEST(PatchHessian, IsThatOfDifferences) {
  constexpr double kStep = 1e-4;
  for (const Patch& p : {Patch{0, 0, 1, 0, 0, -1}, Patch{0.5, -0.3, 0.8, 0, 0, -1}, Patch{1.2, 0.4, 0.3, -0.8, 0, -0.6},
                         Patch{-0.2, 0.9, 0.5, 0.48, -0.6, -0.64}}) {
    const double value = p.sent(0, 0);
    ASSERT_GT(value, 0);
    const TangentMatrix found = p.hessian();
    const double squared = kStep * kStep;
    EXPECT_NEAR(found.xx, (p.sent(kStep, 0) - 2 * value + p.sent(-kStep, 0)) / squared / value, 1e-3 * std::fabs(found.xx) + 1e-3);
    EXPECT_NEAR(found.yy, (p.sent(0, kStep) - 2 * value + p.sent(0, -kStep)) / squared / value, 1e-3 * std::fabs(found.yy) + 1e-3);
    EXPECT_NEAR(
        found.xy,
        (p.sent(kStep, kStep) - p.sent(kStep, -kStep) - p.sent(-kStep, kStep) + p.sent(-kStep, -kStep)) / (4 * squared) / value,
        1e-3 * std::fabs(found.xy) + 1e-3);
  }
}

TEST(PatchHessian, KnowsHowThePatchStands) {
  // The twin: as if the patch faced the receiver.
  const double distance = std::sqrt(0.98);
  const Patch level{0.5, -0.3, 0.8, 0, 0, -1}, facing{0.5, -0.3, 0.8, -0.5 / distance, 0.3 / distance, -0.8 / distance};
  EXPECT_GT(level.hessian().xx, 5 * std::fabs(facing.hessian().xx));
}

GeometricHessian below_a_ceiling(float height) {
  const HemisphereGrid grid(64, 1e4f);
  GeometricHessian hessian;
  for (std::size_t i = 0; i < grid.size(); ++i) {
    const Vec3f d = square_to_cosine_hemisphere(grid.place(i, {0.5f, 0.5f}));
    hessian.add(patch_hessian(d, height / d.z, {0, 0, -1}), 1 / static_cast<double>(grid.size()));
  }
  return hessian;
}

TEST(GeometricHessian, BelowAnEndlessCeilingBalances) {
  const GeometricHessian hessian = below_a_ceiling(2);
  EXPECT_NEAR(hessian.sum.xx, 0, 0.01);
  EXPECT_NEAR(hessian.sum.xy, 0, 0.01);
  EXPECT_GT(hessian.bound.xx, 0.1);
  EXPECT_NEAR(hessian.bound.xx, hessian.bound.yy, 0.01);
}

TEST(GeometricHessian, FallsWithTheSquareOfTheSize) {
  EXPECT_NEAR(below_a_ceiling(1).bound.xx / below_a_ceiling(3).bound.xx, 9, 0.01);
}

TEST(SymmetricMatrix, OfAbsoluteEigenvalues) {
  // Eigenvalues 3 along (1, 1) and -1 along (1, -1).
  const TangentMatrix m = absolute({1, 2, 1});
  EXPECT_NEAR(m.xx, 2, 1e-12);
  EXPECT_NEAR(m.xy, 1, 1e-12);
  EXPECT_NEAR(m.yy, 2, 1e-12);
}

}  // namespace
}  // namespace fluxfarm::ablation
