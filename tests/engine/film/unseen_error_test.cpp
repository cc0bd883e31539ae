// What light that path tracing did not find means for the error.
#include "film/unseen_error.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "film/error_goal.h"
#include "film/tile_grid.h"

namespace fluxfarm {
namespace {

constexpr PixelRect kCrop{8, 4, 64, 32};  // two cells

// Two replicates a pixel that differ by 2 `spread` around value(x).
Film picture(const std::function<double(int)>& value, double spread) {
  Film film(100, 40, kCrop);
  TileSums sums{kCrop, {0, 2}, 0, {}, {}, 0};
  for (int pixel = 0; pixel < kCrop.pixels(); ++pixel) {
    const double v = value(kCrop.x + pixel % kCrop.width);
    for (const double sign : {-1, 1}) sums.radiance.insert(sums.radiance.end(), 3, static_cast<float>(v + sign * spread));
    sums.features.insert(sums.features.end(), kFeatures, 0.0f);
  }
  film.merge(sums);
  return film;
}

LightAudit audit_of(LightAudit::Cell left, LightAudit::Cell right, double share = 0) { return {{left, right}, share}; }

TEST(UnseenError, IsZeroWhereNothingIsMissing) {
  const Film film = picture([](int) { return 0.5; }, 0.1);
  const UnseenError unseen = unseen_error(film, audit_of({0.5, 1e-4, 0, 0}, {0.1, 1e-4, 0, 0}), 1);
  EXPECT_EQ(unseen.error, 0);
  EXPECT_EQ(unseen.energy, 0);
  EXPECT_TRUE(unseen.doubtful.empty());
}

// However the missing light lies in its cell, the error that it makes is at or below the bound; some way it comes close.
TEST(UnseenError, BoundsTheErrorOfLightThatIsMissing) {
  const double found = 0.2, missing = 0.02;
  const Film film = picture([&](int) { return found; }, 0);
  const UnseenError unseen = unseen_error(film, audit_of({found, 1e-6, missing, 0}, {found, 1e-6, missing, 0}, 0.1), 1);
  EXPECT_NEAR(unseen.energy, missing / (found + missing), 1e-6);
  EXPECT_TRUE(unseen.doubtful.empty()) << "more samples do not help";
  EXPECT_EQ(unseen.error, unseen.unreachable_error);
  double worst = 0;
  for (double part = 1; part > 0.01; part *= 0.9) {  // all of it in that part of the pixels
    const double x = missing / part, truth = found + x;
    worst = std::max(worst, std::sqrt(part * x * x / (truth * truth + 1e-2)));
  }
  EXPECT_LE(worst, unseen.error + 1e-9);
  EXPECT_GT(worst, 0.99 * unseen.error);
  // Twin: taken as spread evenly, the error would be far less than it may be.
  const double even = missing / std::sqrt((found + missing) * (found + missing) + 1e-2);
  EXPECT_LT(even, 0.6 * worst);
}

// Missing light that falls on the dark part of a cell costs more than the cell's mean tells.
TEST(UnseenError, BoundsTheErrorOfLightThatIsMissingInTheDark) {
  const double bright = 10, missing = 0.01;
  const auto value = [&](int x) { return x % 32 < 3 ? 0.0 : bright; };  // of 32 columns
  const double dark = 3.0 / 32;
  const Film film = picture(value, 0);
  const UnseenError unseen = unseen_error(film, audit_of({9, 1e-6, missing, 0}, {9, 1e-6, missing, 0}, 0.01), 1);
  double worst = 0;
  for (double part = 1; part > 0.01; part *= 0.9) {  // all of it in that part of the dark pixels
    const double x = missing / (part * dark);
    worst = std::max(worst, std::sqrt(part * dark * x * x / (x * x + 1e-2)));
  }
  EXPECT_GT(worst, 0.2);
  EXPECT_LE(worst, unseen.error);
  EXPECT_LT(unseen.error, 1.5 * worst);
  // Twin: the product of the means, which is no bound.
  const double steepness = dark * 0.5 / 0.1 + (1 - dark) * 0.5 / (bright + std::sqrt(bright * bright + 1e-2));
  EXPECT_LT(std::sqrt(missing * steepness), 0.5 * worst);
}

// However much is missing, no pixel's share is above 1: half of the picture dark and lost, half bright and whole.
TEST(UnseenError, NeverTakesMoreThanThePixelsThere) {
  const Film film = picture([](int x) { return x % 2 == 0 ? 0.0 : 1e4; }, 0);
  const UnseenError unseen = unseen_error(film, audit_of({5e3, 1e-6, 0.2, 0}, {5e3, 1e-6, 0.2, 0}, 0.01), 1);
  EXPECT_NEAR(unseen.error, std::sqrt(0.5), 1e-3);
  const UnseenError all = unseen_error(film, audit_of({5e3, 1e-6, 1e6, 0}, {5e3, 1e-6, 1e6, 0}, 0.9), 1);
  EXPECT_NEAR(all.error, 1, 1e-9);
}

TEST(UnseenError, DoubtsOnlyWhatIsClear) {
  const Film film = picture([](int) { return 0.5; }, 0.2);
  // The mean of 1024 pixels has a standard error of 0.2 / 32.
  const auto doubtful = [&](double radiance, double standard_error) {
    return unseen_error(film, audit_of({radiance, standard_error * standard_error, 0, 0}, {}), 1).doubtful;
  };
  EXPECT_TRUE(doubtful(0.52, 1e-6).empty()) << "within the tolerance";
  EXPECT_TRUE(doubtful(0.54, 1e-6).empty()) << "noise of the paths";
  EXPECT_TRUE(doubtful(0.8, 0.1).empty()) << "noise of the particles";
  EXPECT_EQ(doubtful(0.8, 0.05), (std::vector<std::uint32_t>{0}));
  EXPECT_EQ(unseen_error(film, audit_of({0.8, 0.0025, 0, 0}, {}), 1).unreachable_error, 0);
}

TEST(UnseenError, CountsWhatIsSeenInMirrors) {
  const Film film = picture([](int) { return 0.5; }, 0);
  const UnseenError all = unseen_error(film, audit_of({0, 0, 0, 1}, {0, 0, 0, 0}, 1), 1);
  EXPECT_NEAR(all.error, std::sqrt(0.5), 1e-9) << "half of the picture shows light of which nothing is known";
  const UnseenError part = unseen_error(film, audit_of({0, 0, 0, 1}, {0, 0, 0, 1}, 0.1), 1);
  EXPECT_NEAR(part.error, std::sqrt(0.1 / (4 * 0.9)), 1e-9);
  EXPECT_NE(unseen_warning(all, 0.1).find("mirrors"), std::string::npos);
}

// No sample finds what is unreachable: the picture ends, and says why.
TEST(UnseenError, EndsAPictureThatCannotMeetItsGoal) {
  const Film film = picture([](int) { return 0.5; }, 0.001);
  const LightAudit audit = audit_of({0.5, 1e-6, 0.1, 0}, {0.5, 1e-6, 0, 0}, 0.05);
  const ErrorLook look = look_at(film, {0.05}, 1, &audit);
  EXPECT_FALSE(look.next.has_value());
  EXPECT_GT(look.bound, 0.05);
  EXPECT_GT(look.unseen.value(), 0.05);
  EXPECT_NE(look.warning.find("cannot find"), std::string::npos) << look.warning;
  // Twin: without the audit the goal is claimed.
  const ErrorLook blind = look_at(film, {0.05}, 1);
  EXPECT_LE(blind.bound, 0.05);
  EXPECT_FALSE(blind.unseen.has_value());
  EXPECT_TRUE(blind.warning.empty());
}

// A little that is missing leaves room for noise, but less.
TEST(UnseenError, IsTakenOffTheGoal) {
  const LightAudit audit = audit_of({0.5, 1e-6, 0.002, 0}, {0.5, 1e-6, 0.002, 0}, 0.01);
  const Film film = picture([](int) { return 0.5; }, 0.02);
  const double noise = look_at(film, {1.0}, 1).bound, unseen = look_at(film, {1.0}, 1, &audit).unseen.value();
  ASSERT_LT(unseen, noise) << "else the goal is given up";
  const double both = std::hypot(noise, unseen);
  EXPECT_FALSE(look_at(film, {1.01 * both}, 1, &audit).next.has_value());
  const ErrorLook look = look_at(film, {0.99 * both}, 1, &audit);
  EXPECT_TRUE(look.next.has_value()) << "noise alone would meet it";
  EXPECT_LT(noise, 0.99 * both);
}

// Samples that may find some of the missing light are not taken where others that no sample finds forbid the claim.
TEST(UnseenError, TriesNoDoubtfulCellsWhereTheClaimIsLost) {
  const Film film = picture([](int) { return 0.5; }, 0.001);
  const LightAudit lost = audit_of({0.5, 1e-6, 0.1, 0}, {0.8, 1e-6, 0, 0}, 0.05);
  ASSERT_EQ(unseen_error(film, lost, 1).doubtful, (std::vector<std::uint32_t>{1}));
  ASSERT_GT(unseen_error(film, lost, 1).unreachable_error, 0.05);
  const ErrorLook look = look_at(film, {0.05}, 1, &lost);
  EXPECT_FALSE(look.next.has_value());
  EXPECT_NE(look.warning.find("cannot find"), std::string::npos) << look.warning;
  // Twin: with the doubt alone the cell goes on.
  const LightAudit doubt = audit_of({0.5, 1e-6, 0, 0}, {0.8, 1e-6, 0, 0});
  EXPECT_TRUE(look_at(film, {0.05}, 1, &doubt).next.has_value());
}

TEST(UnseenError, ForeseesTheSamplesOfDoubtfulCells) {
  const Film film = picture([](int) { return 0.5; }, 0.001);
  const LightAudit doubt = audit_of({0.5, 1e-6, 0, 0}, {0.8, 1e-6, 0, 0});
  const double cell = 32 * 32, taken = 2 * cell * 2;
  EXPECT_EQ(look_at(film, {0.05, 65536}, 1, &doubt).samples, taken + cell * (4096 - 2));
  EXPECT_EQ(look_at(film, {0.05, 64}, 1, &doubt).samples, taken + cell * (64 - 2)) << "no more than the limit";
  EXPECT_EQ(look_at(film, {0.05, 65536}, 1).samples, taken) << "twin: without the doubt";
}

// A scene that cannot be audited: a claim says what it rests on, and none is made where paths may never find the light.
// A fifth of the light comes by rare paths, and the left cell is seen through glass: with it its radiance would be 0.5 / 0.8.
TEST(UnseenError, RareLightBehindGlassCountsUntilTheSamplesShowIt) {
  const Film calm = picture([](int) { return 0.5; }, 0), noisy = picture([](int) { return 0.5; }, 0.5);
  const double missing = 0.2 / (4 * 0.8), whole = 0.5 / 0.8;
  LightAudit audit = audit_of({0.5, 1e-4, 0, 1}, {0.5, 1e-4, 0, 0});
  audit.rare_share = 0.2;
  audit.rare_brightness = 1;
  const double left = 0.2 * whole / (whole * whole + 1e-2) / 4096;  // after as many samples as doubt is worth
  const UnseenError doubt = unseen_error(calm, audit, 1);
  EXPECT_NEAR(doubt.error, std::sqrt(missing / 2), 1e-6);
  EXPECT_NEAR(doubt.rare_error, doubt.error, 1e-6);
  EXPECT_NEAR(doubt.unreachable_error, std::sqrt(left / 2), 1e-6);
  EXPECT_EQ(doubt.doubtful, std::vector<std::uint32_t>{0});
  audit.rare_brightness = 1e6;
  const UnseenError hopeless = unseen_error(calm, audit, 1);
  EXPECT_NEAR(hopeless.unreachable_error, hopeless.error, 1e-6);
  EXPECT_NE(unseen_warning(hopeless, 0.05).find("ask for integrator photon-progressive"), std::string::npos);
  // Twin: samples that differ so much have met it.
  const UnseenError met = unseen_error(noisy, audit, 1);
  EXPECT_EQ(met.error, 0);
  EXPECT_TRUE(met.doubtful.empty());
}

TEST(UnseenError, IsToldWhereItIsNotKnown) {
  const Film film = picture([](int) { return 0.5; }, 0.001);
  LightAudit blind, lost;
  blind.outcome = LightAudit::kNotPossible;
  lost.outcome = LightAudit::kNotPossibleWithUnreachable;
  const ErrorLook claimed = look_at(film, {0.05}, 1, &blind);
  EXPECT_LE(claimed.bound, 0.05);
  EXPECT_FALSE(claimed.unseen.has_value());
  EXPECT_NE(claimed.warning.find("noise alone"), std::string::npos) << claimed.warning;
  EXPECT_TRUE(look_at(film, {1e-6}, 1, &blind).warning.empty()) << "not at its end yet";
  const ErrorLook refused = look_at(film, {0.05}, 1, &lost);
  EXPECT_GE(refused.bound, 1);
  EXPECT_FALSE(refused.next.has_value());
  EXPECT_FALSE(refused.unseen.has_value());
  EXPECT_EQ(refused.warning.find("goal not reached"), 0u) << refused.warning;
}

}  // namespace
}  // namespace fluxfarm
