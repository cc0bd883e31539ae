// Many emitters: bounds that hold, probabilities that add up, frequencies that follow them; with twins that must fail.
#include <gtest/gtest.h>

#include <random>

#include "emitters/directional_emitter.h"
#include "emitters/emitter_choice.h"
#include "emitters/spot_emitter.h"
#include "geometry/rectangle.h"
#include "geometry/sphere.h"
#include "support/chi_square.h"

namespace fluxfarm::testing {
namespace {

// All chi-square tests of this file together reject correct code with this probability; the seeds are fixed.
constexpr double kOverallLevel = 0.01;
constexpr int kTests = 6;

class Numbers {
 public:
  explicit Numbers(unsigned seed) : generator_(seed) {}
  float one() { return static_cast<float>(generator_() >> 8) * 0x1p-24f; }
  float between(float a, float b) { return a + (b - a) * one(); }
  Vec3f point(float half) { return {between(-half, half), between(-half, half), between(-half, half)}; }
  Vec3f direction() {
    for (;;) {
      const Vec3f v = point(1);
      const float squared = length_squared(v);
      if (squared > 1e-2f && squared <= 1) return v / std::sqrt(squared);
    }
  }

 private:
  std::mt19937 generator_;
};

// Lamps of every kind, scattered through a cube of half side 5 m, and a mesh of 20 triangles.
class Lamps {
 public:
  explicit Lamps(unsigned seed, int count = 60, bool distant = true) {
    Numbers numbers(seed);
    for (int i = 0; i < count; ++i) {
      const Vec3f p = numbers.point(5);
      const Rgb strength{std::exp(numbers.between(-2, 2))};
      if (i % 4 == 0) {
        const Frame frame(numbers.direction());
        add(std::make_unique<Rectangle>(p, frame.s * numbers.between(0.05f, 2), frame.t * 0.3f, false), strength);
      } else if (i % 4 == 1) {
        add(std::make_unique<Sphere>(p, numbers.between(0.05f, 0.5f), false), strength);
      } else if (i % 4 == 2) {
        emitters_.push_back(std::make_unique<PointEmitter>(p, strength));
      } else {
        const float cutoff = numbers.between(0.1f, 3);
        emitters_.push_back(
            std::make_unique<SpotEmitter>(p, numbers.direction(), strength, cutoff, cutoff * numbers.between(0, 0.99f)));
      }
    }
    TriangleMesh::Data mesh;
    for (std::uint32_t i = 0; i < 60; ++i) {
      mesh.positions.push_back(numbers.point(1) + Vec3f{0, 4, 0});
      mesh.indices.push_back(i);
    }
    mesh_ = emitters_.size();
    add(std::make_unique<TriangleMesh>(mesh, false, true), Rgb{2.0f});
    if (distant) emitters_.push_back(std::make_unique<DirectionalEmitter>(Vec3f{0, -1, 0}, Rgb{0.1f}, 9.0f));
  }

  std::vector<const Emitter*> list() const {
    std::vector<const Emitter*> result;
    for (const auto& emitter : emitters_) result.push_back(emitter.get());
    return result;
  }
  std::size_t mesh() const { return mesh_; }

 private:
  void add(std::unique_ptr<Shape> shape, Rgb radiance) {
    emitters_.push_back(std::make_unique<AreaEmitter>(*shape, radiance));
    shapes_.push_back(std::move(shape));
  }
  std::vector<std::unique_ptr<Shape>> shapes_;
  std::vector<std::unique_ptr<Emitter>> emitters_;
  std::size_t mesh_;
};

std::vector<EmitterBounds> bounds_of(const std::vector<const Emitter*>& emitters) {
  std::vector<EmitterBounds> bounds;
  for (const Emitter* emitter : emitters) {
    if (const auto own = emitter->bounds()) bounds.push_back(*own);
  }
  return bounds;
}

// Surfaces of one and of two sides, and places in the open; some inside lamps.
EmitterReference reference(Numbers& numbers, int i) {
  EmitterReference result{numbers.point(6), {}};
  if (i % 3 > 0) result.normal = numbers.direction();
  result.both_sides = i % 3 == 2;
  return result;
}

TEST(EmitterBounds, JoinedConesHoldAllNormalsOfBoth) {
  Numbers numbers(1);
  for (int i = 0; i < 2000; ++i) {
    EmitterBounds a, b;
    for (EmitterBounds* bounds : {&a, &b}) {
      bounds->box.extend(numbers.point(1));
      bounds->axis = numbers.direction();
      bounds->spread = i % 5 == 0 ? 0 : numbers.between(0, i % 2 == 0 ? 0.5f : kPi);
    }
    if (i % 7 == 0) b.axis = i % 2 == 0 ? a.axis : -a.axis;
    const EmitterBounds both = EmitterBounds::join(a, b);
    EXPECT_NEAR(length(both.axis), 1, 1e-5f);
    bool smaller_would_do = true;
    for (int k = 0; k < 40; ++k) {
      const EmitterBounds& from = k % 2 == 0 ? a : b;
      // A normal on the rim of the cone.
      const float azimuth = numbers.between(0, kTwoPi), s = std::sin(from.spread);
      const Vec3f n = Frame(from.axis).to_world({s * std::cos(azimuth), s * std::sin(azimuth), std::cos(from.spread)});
      const float angle = std::atan2(length(cross(n, both.axis)), dot(n, both.axis));
      EXPECT_LE(angle, both.spread + 1e-3f);
      smaller_would_do &= angle <= 0.5f * both.spread;
    }
    EXPECT_FALSE(smaller_would_do && both.spread > 0) << "a cone of twice the width that is needed";
    for (const EmitterBounds* part : {&a, &b}) {
      for (int axis = 0; axis < 3; ++axis) {
        EXPECT_LE(both.box.lower[axis], part->box.lower[axis]);
        EXPECT_GE(both.box.upper[axis], part->box.upper[axis]);
      }
    }
  }
}

TEST(EmitterBounds, OrientationMeasureIsItsIntegral) {
  for (const auto& [spread, reach] : {std::pair{0.0f, kPi / 2}, std::pair{0.7f, kPi / 2}, std::pair{0.4f, 0.3f},
                                      std::pair{2.5f, kPi / 2}, std::pair{kPi, kPi / 2}}) {
    EmitterBounds bounds;
    bounds.spread = spread;
    bounds.reach = reach;
    double sum = 0;
    constexpr int kSteps = 200000;
    for (int i = 0; i < kSteps; ++i) {
      const double angle = (i + 0.5) * M_PI / kSteps, beyond = std::max(angle - static_cast<double>(spread), 0.0);
      if (beyond < static_cast<double>(reach)) sum += std::cos(beyond) * std::sin(angle) * 2 * M_PI * M_PI / kSteps;
    }
    EXPECT_NEAR(bounds.orientation_measure(), sum, 1e-3);
  }
}

TEST(EmitterTree, ProbabilitiesAddUpToOneOrNoneHelps) {
  const Lamps lamps(2, 200);
  const std::vector<EmitterBounds> bounds = bounds_of(lamps.list());
  const EmitterTree tree(bounds);
  Numbers numbers(3);
  for (int i = 0; i < 300; ++i) {
    const EmitterReference from = reference(numbers, i);
    double sum = 0;
    for (std::size_t e = 0; e < tree.size(); ++e) sum += static_cast<double>(tree.probability(from, e));
    // Where a pair below promised more than both of its halves keep, some of the numbers come to nothing.
    EXPECT_LE(sum, 1 + 1e-4);
    int empty = 0;
    constexpr int kSamples = 500;
    for (int k = 0; k < kSamples; ++k) {
      const auto choice = tree.sample(from, (static_cast<float>(k) + 0.5f) / kSamples);
      empty += !choice;
      if (!choice) continue;
      const float probability = tree.probability(from, choice->index);
      EXPECT_NEAR(choice->probability, probability, 1e-4f * probability);
    }
    EXPECT_NEAR(1 - sum, static_cast<double>(empty) / kSamples, 0.05) << i;
  }
}

TEST(EmitterTree, FrequenciesFollowTheProbabilities) {
  const Lamps lamps(4);
  const EmitterTree tree(bounds_of(lamps.list()));
  Numbers numbers(5);
  for (int i = 0; i < 5; ++i) {
    const EmitterReference from = reference(numbers, i), elsewhere = reference(numbers, i);
    constexpr int kSamples = 200000;
    std::vector<double> observed(tree.size() + 1);
    for (int k = 0; k < kSamples; ++k) {
      const auto choice = tree.sample(from, numbers.one());
      ++observed[choice ? choice->index : tree.size()];
    }
    const auto p_value = [&](const EmitterReference& asked) {
      std::vector<std::pair<double, double>> cells;
      double sum = 0;
      for (std::size_t e = 0; e < tree.size(); ++e) {
        const auto p = static_cast<double>(tree.probability(asked, e));
        cells.emplace_back(p * kSamples, observed[e]);
        sum += p;
      }
      cells.emplace_back(std::max(1 - sum, 0.0) * kSamples, observed.back());
      return pearson_p_value(cells);
    };
    EXPECT_GT(p_value(from), sidak_level(kOverallLevel, kTests));
    EXPECT_LT(p_value(elsewhere), 1e-12) << "twin: the probabilities of another place are told apart";
  }
}

// Light that can arrive: brute force over points of the emitter.
bool lights(const Emitter& emitter, const EmitterReference& from, Numbers& numbers) {
  for (int k = 0; k < 16; ++k) {
    const auto sample = emitter.sample(from.position, {numbers.one(), numbers.one()});
    if (!sample || sample->weight.is_black()) continue;
    const float cosine = from.normal == Vec3f{} ? 1.0f : dot(sample->wi, from.normal);
    if (from.both_sides || cosine > 1e-5f) return true;
  }
  return false;
}

TEST(EmitterTree, NeverLeavesOutAnEmitterThatBringsLight) {
  const Lamps lamps(6, 100, false);
  const std::vector<const Emitter*> list = lamps.list();
  std::vector<EmitterBounds> narrow = bounds_of(list);
  const EmitterTree tree(narrow);
  // Twin: bounds that forget how wide lamps are and how far they shine.
  for (EmitterBounds& bounds : narrow) {
    const Vec3f middle = bounds.box.center();
    bounds.box = {middle, middle};
    if (bounds.spread < 0.1f) bounds.reach = 1.2f;
  }
  const EmitterTree wrong(narrow);
  Numbers numbers(7);
  int lit = 0, dark = 0, left_out = 0;
  for (int i = 0; i < 600; ++i) {
    const EmitterReference from = reference(numbers, i);
    for (std::size_t e = 0; e < lamps.mesh(); ++e) {
      const bool zero = tree.probability(from, e) == 0;
      dark += zero;
      if (!lights(*list[e], from, numbers)) continue;
      ++lit;
      EXPECT_FALSE(zero) << "emitter " << e << " from place " << i;
      left_out += wrong.probability(from, e) == 0;
    }
  }
  EXPECT_GT(lit, 10000);
  EXPECT_GT(dark, 5000) << "it does leave out emitters that bring none";
  EXPECT_GT(left_out, 100) << "the test has no teeth";
}

TEST(EmitterTree, ServesEmittersInOnePlaceOnALineAndWithoutLight) {
  for (int kind = 0; kind < 3; ++kind) {
    std::vector<EmitterBounds> bounds(33);
    for (std::size_t i = 0; i < bounds.size(); ++i) {
      bounds[i].box.extend({kind == 1 ? static_cast<float>(i) : 0.0f, 0, 0});
      bounds[i].intensity = kind == 2 ? 0.0f : 1.0f;
    }
    const EmitterTree tree(bounds);
    const EmitterReference from{{0, 3, 0}, {}};
    double sum = 0;
    for (std::size_t i = 0; i < bounds.size(); ++i) sum += static_cast<double>(tree.probability(from, i));
    EXPECT_NEAR(sum, kind == 2 ? 0 : 1, 1e-5);
    EXPECT_EQ(tree.sample(from, 0.5f).has_value(), kind != 2);
    EXPECT_TRUE(kind == 2 || tree.sample({}, 0.5f).has_value()) << "right in an emitter";
  }
}

TEST(EmitterTree, SameListGivesTheSameTree) {
  const Lamps lamps(8);
  const EmitterTree one(bounds_of(lamps.list())), other(bounds_of(lamps.list()));
  Numbers numbers(9);
  for (int i = 0; i < 100; ++i) {
    const EmitterReference from = reference(numbers, i);
    EXPECT_EQ(one.probability(from, 7), other.probability(from, 7));
  }
}

TEST(EmitterChoice, LoneEmitterNeedsNoTree) {
  const Lamps lamps(10);
  const Emitter* lamp = lamps.list().front();
  const EmitterChoice choice({lamp});
  EXPECT_TRUE(choice.single());
  EXPECT_FALSE(choice.by_place());
  EXPECT_EQ(choice.sample({}, 0)->probability, 1);
  EXPECT_TRUE(EmitterChoice({lamps.list()[lamps.mesh()]}).single()) << "a mesh of few triangles";
  EXPECT_TRUE(EmitterChoice().empty());
}

TEST(EmitterChoice, TrianglesStandByThemselvesAndLightFromOutsideKeepsItsShare) {
  const Lamps lamps(11, 8);
  const EmitterChoice choice(lamps.list());
  EXPECT_EQ(choice.candidates(), 8 + 20 + 1u);
  const float sun = choice.distant_probability(9);
  EXPECT_GT(sun, 0.25f - 1e-6f);
  Numbers numbers(12);
  constexpr int kSamples = 100000;
  int found = 0;
  for (int i = 0; i < kSamples; ++i) {
    const auto chosen = choice.sample({}, numbers.one());
    if (chosen && chosen->emitter == lamps.list()[9]) {
      ++found;
      EXPECT_FLOAT_EQ(chosen->probability, sun);
    }
  }
  EXPECT_NEAR(static_cast<double>(found) / kSamples, static_cast<double>(sun), 0.01);
}

}  // namespace
}  // namespace fluxfarm::testing
