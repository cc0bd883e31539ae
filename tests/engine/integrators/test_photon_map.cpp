// The photon map finds what looking at every photon finds.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

#include "integrators/photon/photon_map.h"

namespace fluxfarm {
namespace {

// On three surfaces, some crowded, with a few in the very same place. The flux tells a photon's index.
std::vector<Photon> photons_of(std::size_t count) {
  std::mt19937 random(static_cast<unsigned>(count));
  std::uniform_real_distribution<float> unit(0, 1);
  std::vector<Photon> photons;
  for (std::size_t i = 0; i < count; ++i) {
    const float u = unit(random), v = unit(random);
    Vec3f p = i % 3 == 0 ? Vec3f{u, 0, v} : i % 3 == 1 ? Vec3f{0, u, v} : Vec3f{u * u * u, v * v * v, 1};
    if (i % 7 == 6) p = photons[i / 2].position;
    const Vec3f up{0, 1, 0};
    photons.push_back({p, PhotonLight(Rgb{static_cast<float>(i % 128 + 128)}, up, up, PhotonKind::kDirect, 1, 0)});
  }
  return photons;
}

// Squared distances of what is near, in order, with the flux.
using Found = std::vector<std::pair<float, float>>;

Found sorted(Found found) {
  std::ranges::sort(found);
  return found;
}

Found all_within(const std::vector<Photon>& photons, Vec3f center, float radius) {
  Found found;
  for (const Photon& photon : photons) {
    const float d2 = length_squared(photon.position - center);
    if (d2 <= radius * radius) found.emplace_back(d2, photon.light.flux().g);
  }
  return sorted(found);
}

Found map_within(const PhotonMap& map, Vec3f center, float radius) {
  Found found;
  map.for_each_within(center, radius,
                      [&](Vec3f d, const PhotonLight& light) { found.emplace_back(length_squared(d), light.flux().g); });
  return found;
}

std::vector<Vec3f> places() {
  std::mt19937 random(9);
  std::uniform_real_distribution<float> unit(-0.2f, 1.2f);
  std::vector<Vec3f> places{{0, 0, 0}, {0.5f, 0, 0.5f}, {0, 0, 1}, {50, 0, 0}};
  for (int i = 0; i < 60; ++i) places.push_back({unit(random), unit(random), unit(random)});
  return places;
}

const std::vector<std::size_t> kSizes{0, 1, 2, 15, 16, 17, 31, 33, 48, 49, 100, 257, 1000, 5000};

TEST(PhotonMap, FindsAllWithinARadius) {
  for (const std::size_t size : kSizes) {
    const std::vector<Photon> photons = photons_of(size);
    const PhotonMap map(photons, 2);
    EXPECT_EQ(map.size(), size);
    for (const Vec3f place : places()) {
      for (const float radius : {0.01f, 0.1f, 0.5f, 3.0f}) {
        EXPECT_EQ(sorted(map_within(map, place, radius)), all_within(photons, place, radius)) << size;
      }
    }
  }
}

TEST(PhotonMap, FindsTheNearest) {
  NearestPhotons nearest;
  for (const std::size_t size : kSizes) {
    const std::vector<Photon> photons = photons_of(size);
    const PhotonMap map(photons, 2);
    for (const Vec3f place : places()) {
      for (const std::size_t count : {1, 2, 10, 100, 1000}) {
        for (const float radius : {0.2f, 1e19f}) {
          nearest.start(count, radius * radius);
          map.find_nearest(
              place, [](Vec3f, const PhotonLight&) { return true; }, nearest);
          nearest.finish();
          std::vector<float> found(nearest.distances_squared().begin(), nearest.distances_squared().end()), expected;
          std::ranges::sort(found);
          for (const auto& [d2, flux] : all_within(photons, place, radius)) expected.push_back(d2);
          if (expected.size() > count) expected.resize(count);
          EXPECT_EQ(found, expected) << size << " photons, " << count << " wanted";
          if (found.empty()) continue;
          EXPECT_EQ(nearest.distances_squared()[nearest.farthest()], found.back());
        }
      }
    }
  }
}

TEST(PhotonMap, CountsAmongTheNearestOnlyWhatIsAccepted) {
  const std::vector<Photon> photons = photons_of(3000);
  const PhotonMap map(photons, 2);
  const auto bright = [](Vec3f, const PhotonLight& light) { return light.flux().g > 200; };
  NearestPhotons nearest;
  for (const Vec3f place : places()) {
    nearest.start(50, 1e30f);
    map.find_nearest(place, bright, nearest);
    nearest.finish();
    EXPECT_EQ(nearest.size(), 50u);
    for (const std::uint32_t photon : nearest.photons()) EXPECT_GT(map.light(photon).flux().g, 200);
    std::vector<float> expected;
    for (const Photon& photon : photons) {
      if (bright({}, photon.light)) expected.push_back(length_squared(photon.position - place));
    }
    std::ranges::sort(expected);
    EXPECT_EQ(nearest.distances_squared()[nearest.farthest()], expected[49]);
  }
}

TEST(PhotonMap, IsTheSameOnAnyNumberOfThreads) {
  const std::vector<Photon> photons = photons_of(20000);
  const PhotonMap one(photons, 1), three(photons, 3);
  for (const Vec3f place : places()) EXPECT_EQ(map_within(one, place, 0.3f), map_within(three, place, 0.3f));
  std::vector<Photon> reversed(photons.rbegin(), photons.rend());
  const PhotonMap other(reversed, 1);
  EXPECT_NE(map_within(one, {0.5f, 0, 0.5f}, 0.3f), map_within(other, {0.5f, 0, 0.5f}, 0.3f));  // the test can tell
}

}  // namespace
}  // namespace fluxfarm
