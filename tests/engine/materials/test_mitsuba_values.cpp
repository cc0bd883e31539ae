// Our values against Mitsuba's, at a few pairs of directions for every BSDF.
#include <gtest/gtest.h>

#include "cases.h"

namespace fluxfarm::testing {
namespace {

struct Row {
  std::string name;
  float wo[2], wi[2];  // cosine and azimuth
  float f[3];          // sr^-1
  float pdf;           // sr^-1
};

const std::vector<Row> kRows = {
#include "mitsuba_values.inc"
};

std::unique_ptr<Bsdf> rough(const std::string& kind, const Roughness& r) {
  if (kind == "roughconductor") return make(RoughConductorDescription{gold(), r});
  if (kind == "roughdielectric") return make(RoughDielectricDescription{{}, r});
  return make(RoughPlasticDescription{painted_plastic(), r});
}

// The material that a row's name means: kind, or kind_distribution_alpha.
std::unique_ptr<Bsdf> material(const std::string& name) {
  if (name == "diffuse") return make(DiffuseDescription{{0.7f, 0.5f, 0.2f}});
  if (name == "plastic") return make(painted_plastic());
  if (name == "plastic_nonlinear") return make(painted_plastic(true));
  const std::size_t first = name.find('_'), second = name.find('_', first + 1);
  const bool is_ggx = name.substr(first + 1, second - first - 1) == "ggx";
  const std::string alpha = name.substr(second + 1);
  Roughness r = is_ggx ? ggx(0.2f) : beckmann(0.2f);
  if (alpha == "aniso") {
    r.alpha_v = 0.6f;
  } else {
    r.alpha_u = r.alpha_v = std::stof(alpha);
  }
  return rough(name.substr(0, first), r);
}

struct Tolerance {
  double f = 1e-4, pdf = 1e-4;  // relative
};

Tolerance tolerance(const std::string& name) {
  Tolerance t;
  // Single precision on both sides resolves the half vector of a narrow lobe to 1e-7 / alpha.
  if (name.ends_with("0.05")) t = {3e-4, 3e-4};
  // Our density of Beckmann normals has the exact G1, Mitsuba's the fit.
  if (name.find("beckmann") != std::string::npos) t.pdf = 6e-3;
  // The coat's tables are integrated with other points; the lobe's probability magnifies the error of a transmittance near 1.
  if (name.starts_with("roughplastic")) t = {2.5e-3, 1e-2};
  return t;
}

TEST(MitsubaValues, AgreeForEveryBsdf) {
  for (const Row& row : kRows) {
    SCOPED_TRACE(row.name + " wo.z " + std::to_string(row.wo[0]) + " wi.z " + std::to_string(row.wi[0]));
    const bool twosided = row.name == "twosided";
    const auto pair = make_bsdfs({TwosidedDescription{1, 1}, DiffuseDescription{{0.7f, 0.5f, 0.2f}}});
    const auto single = twosided ? nullptr : material(row.name);
    const Bsdf& bsdf = twosided ? *pair[0] : *single;
    const BsdfValue v = bsdf.value(direction(row.wo[0], row.wo[1]), direction(row.wi[0], row.wi[1]));
    const Tolerance t = tolerance(row.name);
    const double f[3] = {v.f.r, v.f.g, v.f.b};
    for (int channel = 0; channel < 3; ++channel) {
      EXPECT_NEAR(f[channel], row.f[channel], t.f * row.f[channel] + 1e-9)
          << "channel " << channel << " relative " << f[channel] / row.f[channel] - 1;
    }
    EXPECT_NEAR(v.pdf, row.pdf, t.pdf * row.pdf + 1e-9) << "pdf relative " << v.pdf / row.pdf - 1;
  }
}

// Twin: a roughness that is wrong by 1 % is noticed.
TEST(MitsubaValuesTwin, RoughnessOffByOnePercentIsNoticed) {
  const Row& row = *std::find_if(kRows.begin(), kRows.end(), [](const Row& r) { return r.name == "roughconductor_ggx_0.3"; });
  const auto bsdf = make(RoughConductorDescription{gold(), ggx(0.303f)});
  const Rgb f = bsdf->value(direction(row.wo[0], row.wo[1]), direction(row.wi[0], row.wi[1])).f;
  EXPECT_GT(std::abs(f.r / row.f[0] - 1), 1e-3);
}

}  // namespace
}  // namespace fluxfarm::testing
