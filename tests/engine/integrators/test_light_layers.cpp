// Which layer light belongs to, and that the layers add up to beauty.
//
// Estimates are tested two-sided with Student's t over the 16 pixels, which are independent: 15 degrees of freedom, 1 % overall
// (Sidak over fewer than 20 comparisons, 5e-4 each), each with a must-fail twin.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "integrators/light_history.h"
#include "support/scene_builder.h"

namespace fluxfarm::testing {
namespace {

constexpr double kPiD = 3.14159265358979323846;
// Student's t with 15 degrees of freedom at 1 - 2.5e-4.
constexpr double kT = 4.42;

Image render(const SceneDescription& description, std::uint32_t spp) {
  const Scene scene(description, 1);
  const auto integrator = make_integrator("path", scene);
  const std::atomic<bool> never{false};
  const PixelRect frame{0, 0, description.film.width, description.film.height};
  return render_frame(scene, *integrator, {frame, 64, 1, 1, {spp, {}, {}}}, never).film.image(frame, {});
}

std::vector<std::string> layers_of(const Image& image) {
  std::vector<std::string> names;
  for (const char* name : kLightLayerNames) {
    if (image.find(std::string(name) + ".R") != nullptr) names.emplace_back(name);
  }
  return names;
}

Measurement mean_of(const std::vector<float>& values) {
  Measurement m;
  const double n = static_cast<double>(values.size());
  for (const float v : values) m.mean += static_cast<double>(v) / n;
  double squares = 0;
  for (const float v : values) squares += std::pow(static_cast<double>(v) - m.mean, 2);
  m.standard_error = std::sqrt(squares / (n * (n - 1)));
  return m;
}

// The green channel of a layer; zero where the image does not have it.
Measurement layer(const Image& image, const std::string& name) {
  const std::vector<float>* values = image.find(name + ".G");
  return values == nullptr ? Measurement{} : mean_of(*values);
}

void expect_answer(const Measurement& m, double expected) {
  EXPECT_LE(m.standard_error, 0.007 * expected) << "too noisy to see an error of 4 %";
  EXPECT_LE(m.z(expected), kT) << "measured " << m.mean << " +- " << m.standard_error << ", expected " << expected;
  EXPECT_GT(m.z(1.04 * expected), kT) << "the test has no teeth";
}

// Largest difference of beauty and the sum of all layers but `left_out`, over the largest value of beauty there.
double mismatch(const Image& image, const std::string& left_out = "") {
  double worst = 0;
  for (const char* channel : {"R", "G", "B"}) {
    const std::vector<float>& beauty = *image.find(channel);
    for (std::size_t i = 0; i < beauty.size(); ++i) {
      double sum = 0;
      for (const std::string& name : layers_of(image)) {
        if (name != left_out) sum += static_cast<double>((*image.find(name + "." + channel))[i]);
      }
      worst = std::max(worst, std::abs(sum - static_cast<double>(beauty[i])) / std::max(1e-3, static_cast<double>(beauty[i])));
    }
  }
  return worst;
}

// A lamp, a floor, a wall and a ball of that material; in a medium, if there is one.
SceneDescription room(const MaterialDescription& ball, const HomogeneousMediumDescription* medium = nullptr) {
  SceneBuilder scene;
  const int grey = scene.diffuse(0.7f);
  scene.floor(0, 4, grey);
  scene.shape(RectangleDescription{Transform::translate(0, 0, 2) * Transform::rotate(0, 1, 0, 180) * Transform::scale(4, 4, 1)},
              grey);
  scene.lamp_down(0.3f, 2, 0, 1, 1, scene.diffuse(0), 4);
  scene.shape(SphereDescription{{0, 0.6f, 0}, 0.5f}, scene.add(ball));
  if (medium != nullptr) scene.camera_in(scene.medium(*medium));
  scene.look({0, 1.5, -4}, {0, 0.4, 0});
  SceneDescription description = scene.description();
  description.camera.fov_degrees = 40;
  description.film.width = description.film.height = 24;
  return description;
}

using Names = std::vector<std::string>;
const HomogeneousMediumDescription kFog{Rgb{0.2f}, Rgb{0.8f}, 0.3f};

struct Split {
  SceneDescription scene;
  Names layers;
};

TEST(LightLayers, AddUpToBeautyInEveryPixelAndAreThoseThatTheSceneCanHave) {
  const std::vector<Split> cases = {
      {room(DiffuseDescription{}), {"direct", "indirect"}},
      {room(DielectricDescription{}), {"direct", "specular", "caustic", "indirect"}},
      {room(PlasticDescription{}), {"direct", "specular", "caustic", "indirect"}},
      {room(RoughConductorDescription{}), {"direct", "indirect"}},
      {room(NullDescription{}), {"direct", "indirect"}},
      {room(DiffuseDescription{}, &kFog), {"direct", "indirect", "volume"}},
      {room(DielectricDescription{}, &kFog), {"direct", "specular", "caustic", "indirect", "volume"}}};
  for (const Split& c : cases) {
    const Image image = render(c.scene, 32);
    EXPECT_EQ(layers_of(image), c.layers);
    EXPECT_LT(mismatch(image), 1e-6);
    for (const std::string& name : c.layers) EXPECT_GT(mismatch(image, name), 1e-2) << "twin: " << name << " is not empty";
  }
}

// D: a continuous lobe, S: a delta lobe, P: passed as if nothing was there, M: a medium; from the eye towards the light.
LightHistory after(const std::string& events) {
  LightHistory history;
  for (const char event : events) {
    if (event == 'M') {
      history.scatter_in_medium();
    } else {
      BsdfSample sample;
      sample.delta = event != 'D';
      sample.passes = event == 'P';
      history.scatter_at_surface(sample);
    }
  }
  return history;
}

TEST(LightHistory, KnowsTheLayerOfEveryWay) {
  const std::vector<std::pair<LightLayer, std::vector<std::string>>> ways = {
      {LightLayer::kDirect, {"", "D", "P", "PD", "DP", "PPDP"}},
      {LightLayer::kSpecular, {"S", "SS", "SD", "SDS", "PS", "SM", "SDD"}},
      {LightLayer::kCaustic, {"DS", "DSS", "PDS", "DPSP", "DSSS"}},
      {LightLayer::kIndirect, {"DD", "DSD", "DDS", "DM", "DSM", "DPD", "DMS", "DDDD"}},
      {LightLayer::kVolume, {"M", "MD", "MS", "MM", "PM", "MDS"}}};
  for (const auto& [layer, words] : ways) {
    for (const std::string& word : words) {
      EXPECT_EQ(after(word).layer(), layer) << word;
      // Next-event estimation, which adds the event at hand itself.
      if (word.ends_with('D')) {
        EXPECT_EQ(after(word.substr(0, word.size() - 1)).layer_by_surface(), layer) << word;
      }
      if (word.ends_with('M')) {
        EXPECT_EQ(after(word.substr(0, word.size() - 1)).layer_by_medium(), layer) << word;
      }
    }
  }
}

// A floor of reflectance 0.6 under a point light of 1 W/sr that hangs 2 m high and 0.5 m beside the middle.
SceneBuilder lit_floor() {
  SceneBuilder scene;
  scene.floor(0, 1, scene.diffuse(0.6f));
  scene.emitter(PointEmitterDescription{{0.5f, 2, 0}, Rgb{1.0f}});
  return scene;
}
// Of the middle: rho / pi cos / d^2.
const double kLitFloor = 0.6 / kPiD * 2 / std::pow(4.25, 1.5);

// All of beauty's radiance of `expected` is in that layer.
void expect_alone(const Image& image, const std::string& name, double expected) {
  EXPECT_NEAR(mean_of(*image.find("G")).mean, expected, 1e-4 * expected);
  for (const std::string& other : layers_of(image)) {
    EXPECT_NEAR(layer(image, other).mean, other == name ? expected : 0, other == name ? 1e-4 * expected : 0) << other;
  }
}

TEST(LightLayers, OfAFloorUnderAPointLightAreDirectAlone) {
  SceneBuilder scene = lit_floor();
  scene.look({0.3, 1, 0}, {0, 0, 0});
  expect_alone(render(scene.description(), 16), "direct", kLitFloor);
}

TEST(LightLayers, OfTheSameSeenInAMirrorAreSpecularAlone) {
  SceneBuilder scene = lit_floor();
  ConductorDescription mirror;
  mirror.perfect = true;
  // At 45 degrees above the middle of the floor: it shows the floor to a camera that looks along the horizon.
  scene.shape(
      RectangleDescription{Transform::translate(0, 1, 0) * Transform::rotate(1, 0, 0, 45) * Transform::scale(0.05, 0.05, 1)},
      scene.add(TwosidedDescription{2, 2}));
  scene.add(mirror);
  scene.look({0, 1, 2}, {0, 1, 0});
  expect_alone(render(scene.description(), 16), "specular", kLitFloor);
}

// An even sky of radiance 1 over a disk of reflectance 0.6 under a cover: rho times what the cover lets through.
Image under_cover(const MaterialDescription& cover, const MaterialDescription& held = DiffuseDescription{Rgb{0.0f}}) {
  SceneBuilder scene;
  scene.floor(0, 0.05f, scene.diffuse(0.6f));
  scene.shape(SphereDescription{{0, 0, 0}, 1}, scene.add(cover));
  scene.add(held);
  scene.emitter(ConstantEmitterDescription{Rgb{1.0f}});
  scene.look({0.2, 0.5, 0}, {0, 0, 0});
  return render(scene.description(), 1024);
}

TEST(LightLayers, OfLightThroughGlassAreCausticThroughABoundaryWithoutOneDirect) {
  DielectricDescription air;
  air.eta = 1;
  const Image glass = under_cover(air);
  EXPECT_NEAR(layer(glass, "caustic").mean, 0.6, 1e-5);
  EXPECT_EQ(layer(glass, "direct").mean, 0);
  // Twins: what passes as if nothing was there is no scattering. Mask: half of the light is let through.
  const Image null = under_cover(NullDescription{});
  EXPECT_NEAR(layer(null, "direct").mean, 0.6, 1e-5);
  EXPECT_EQ(layer(null, "caustic").mean, 0);
  const Image mask = under_cover(MaskDescription{2, {0.5f}});
  expect_answer(layer(mask, "direct"), 0.3);
  EXPECT_EQ(layers_of(mask), (Names{"direct", "indirect"}));
}

// A closed ball that emits 1 and reflects rho: Le + rho Le without a bounce in between, rho^2 Le / (1 - rho) with some.
TEST(LightLayers, OfAFurnaceAreTheTermsOfItsSeries) {
  SceneBuilder scene;
  scene.shape(SphereDescription{{0, 0, 0}, 1}, scene.diffuse(0.5f), 1, true);
  scene.look({0, 0, 0}, {0, 0, 1});
  const Image image = render(scene.description(), 1024);
  EXPECT_NEAR(layer(image, "direct").mean, 1.5, 1e-4);
  expect_answer(layer(image, "indirect"), 0.5);
}

// Catalogue M4, before a wall of reflectance 0.6: the airlight is the same
// as before a black wall, and the wall's own light, dimmed on both ways, stays direct.
TEST(LightLayers, OfFogAreItsAirlightAndTheDimmedWall) {
  constexpr double kWall = 4, kFoot = 2, kSigma = 0.5;
  SceneBuilder scene;
  scene.shape(RectangleDescription{Transform::translate(0, 0, -kWall) * Transform::scale(5, 5, 1)}, scene.diffuse(0.6f));
  scene.emitter(PointEmitterDescription{{0, 1, -kFoot}, Rgb{1.0f}});
  scene.camera_in(scene.medium({Rgb{kSigma}, Rgb{0.8f}, 0}));
  scene.look({0, 0, 0}, {0, 0, -1}).near_clip(1e-6f).max_depth(2);
  const Image image = render(scene.description(), 8192);
  expect_answer(layer(image, "volume"), 0.01485799);
  const double distance = std::hypot(kWall - kFoot, 1), cosine = (kWall - kFoot) / distance;
  expect_answer(layer(image, "direct"), 0.6 / kPiD * cosine / (distance * distance) * std::exp(-kSigma * (distance + kWall)));
  EXPECT_EQ(layer(image, "indirect").mean, 0);
}

}  // namespace
}  // namespace fluxfarm::testing
