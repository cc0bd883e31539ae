#include "film/unseen_error.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <iomanip>
#include <sstream>

#include "film/error_bound.h"
#include "film/error_goal.h"
#include "film/tile_grid.h"

namespace fluxfarm {
namespace {

// Probability that chance makes any cell of a picture look as if light was missing, over all looks: k-th look, 2^-k of it.
constexpr double kFalseAlarm = 0.01;
// So much more than the paths found is no difference: the edges of cells are not exactly those of the pixel filter, and smooth
// surfaces under a normal map are followed only nearly as paths are.
constexpr double kTolerance = 0.05;

// What the paths found in a cell.
struct Found {
  double radiance = 0, variance = 0;  // of the mean over pixels, R, G, B
  std::vector<double> steepness;      // of each pixel: share of relMSE that missing light makes, at most, per radiance; falling
  double noise = 0;                   // share of relMSE
};

Found found_in(const Film& film, PixelRect cell) {
  Found found;
  found.steepness.reserve(static_cast<std::size_t>(cell.pixels()));
  for (int y = cell.y; y < cell.y + cell.height; ++y) {
    for (int x = cell.x; x < cell.x + cell.width; ++x) {
      const PixelEstimate pixel = film.estimate(x, y);
      double& steepness = found.steepness.emplace_back(0);
      for (int c = 0; c < 3; ++c) {
        const double value = std::max(static_cast<double>(pixel.mean[c]), 0.0);
        const double standard_error = static_cast<double>(pixel.standard_error[c]);
        found.radiance += value / 3;
        found.variance += standard_error * standard_error / 3;  // at most: as if the channels rose and fell together
        found.noise += standard_error * standard_error / (value * value + 1e-2) / 3;
        steepness += 0.5 / (value + std::sqrt(value * value + 1e-2)) / 3;
      }
    }
  }
  const double pixels = cell.pixels();
  found.radiance /= pixels;
  found.variance /= pixels * pixels;
  found.noise /= pixels;
  std::ranges::sort(found.steepness, std::greater<>());
  return found;
}

// Largest mean share of relMSE that missing light of that mean can make in a cell, however it lies there.
double worst_share(const Found& found, double missing) {
  const double pixels = static_cast<double>(found.steepness.size());
  double left = missing * pixels, lost = 0;
  for (const double steepness : found.steepness) {
    const double here = std::min(left, 1 / steepness);
    lost += here * steepness;
    left -= here;
    if (!(left > 0)) break;
  }
  return lost / pixels;
}

// Share of relMSE where that share of the light is missing, at most.
double loss_without(double share) { return share < 1 ? std::min(1.0, share / (4 * (1 - share))) : 1.0; }

// Share of relMSE in a cell by rare light behind smooth surfaces, beyond what its samples show: after those, and after as many as
// doubt is worth.
struct RareShare {
  double now = 0, in_the_end = 0;
};

RareShare rare_share(const Found& found, double blind, const LightAudit& audit, std::uint32_t samples) {
  if (!(blind > 0 && audit.rare_share > 0)) return {};
  // With it the cell would have that radiance; a dark one hides how much it misses, and no less counts than the errors of relMSE
  // do.
  const double whole = std::max(found.radiance / std::max(1 - audit.rare_share, 0.1), 0.1);
  const double of_one = audit.rare_share * audit.rare_brightness * whole / (whole * whole + 1e-2);
  const auto after = [&](std::uint32_t count) { return blind * std::min(loss_without(audit.rare_share), of_one / count); };
  const double missing = after(samples) - found.noise;
  if (!(missing > 0)) return {};
  return {missing, std::min(missing, after(std::max(samples, kMostForDoubt)))};
}

}  // namespace

UnseenError unseen_error(const Film& film, const LightAudit& audit, int number) {
  const std::vector<PixelRect> cells = make_tiles(film.crop(), kErrorTile);
  const double z = gaussian_upper_quantile(std::ldexp(kFalseAlarm, -number) / static_cast<double>(cells.size()));
  // Behind smooth surfaces the share of missing light is taken to be that of the whole scene.
  const double blind_loss = loss_without(audit.unreachable_share);
  UnseenError unseen;
  double error = 0, unreachable_error = 0, rare_error = 0, missing_light = 0, light = 0;
  for (std::uint32_t i = 0; i < cells.size(); ++i) {
    const LightAudit::Cell& audited = audit.cells[i];
    const Found found = found_in(film, cells[i]);
    const double pixels = cells[i].pixels();
    const double excess = audited.radiance - (1 + kTolerance) * found.radiance;
    const bool doubtful = excess > z * std::sqrt(audited.variance + found.variance);
    const RareShare rare = rare_share(found, audited.blind, audit, film.samples(cells[i].x, cells[i].y));
    if (doubtful || rare.now > 0) unseen.doubtful.push_back(i);
    const double missing = audited.unreachable + (doubtful ? audited.radiance - found.radiance : 0.0);
    const double blind = audited.blind * blind_loss;
    unreachable_error += pixels * std::min(1.0, worst_share(found, audited.unreachable) + blind + rare.in_the_end);
    error += pixels * std::min(1.0, worst_share(found, missing) + blind + rare.now);
    rare_error += pixels * rare.now;
    missing_light += pixels * missing;
    light += pixels * (found.radiance + missing);
  }
  unseen.error = std::sqrt(error / film.crop().pixels());
  unseen.unreachable_error = std::sqrt(unreachable_error / film.crop().pixels());
  unseen.rare_error = std::sqrt(rare_error / film.crop().pixels());
  if (light > 0) unseen.energy = missing_light / light;
  return unseen;
}

std::string unseen_warning(const UnseenError& unseen, double goal) {
  const bool never =
      unseen.unreachable_error >= goal || 2 * unseen.unreachable_error * unseen.unreachable_error >= unseen.error * unseen.error;
  std::ostringstream text;
  text << std::setprecision(3);
  if (2 * unseen.rare_error * unseen.rare_error >= unseen.error * unseen.error) {
    text << "goal not reached: light that path tracing finds too rarely makes an error of up to " << unseen.error
         << ", expected at most " << goal
         << " in all; mirrors or glass throw it on surfaces that are seen in mirrors or through glass: ask for integrator "
            "photon-progressive, which looks for such light, or auto";
    return text.str();
  }
  text << "goal not reached: light that path tracing " << (never ? "cannot find" : "finds too rarely")
       << " makes an error of up to " << unseen.error << ", expected at most " << goal << " in all; about "
       << std::lround(100 * unseen.energy) << " % of the picture's light is missing";
  if (unseen.energy == 0) text << " where surfaces are seen directly, and an unknown part in mirrors and glass";
  text << (never
               ? "; point, spot and directional emitters shine over mirrors or through glass: ask for integrator "
                 "photon-progressive, which finds such light, or give them a size, as a small sphere or disk"
               : "; it arrives over paths that are hardly ever sampled: enlarge the emitters or openings that it comes through, or "
                 "judge a long picture with a goal of samples yourself");
  return text.str();
}

std::string unaudited_warning() {
  return "claimed from noise alone: scenes with media or null boundaries are not audited for light that path tracing misses";
}

std::string unclaimed_warning() {
  return "goal not reached: light that path tracing cannot find may be missing, for point, spot and directional emitters may shine "
         "over mirrors or through glass, and scenes with media or null boundaries are not audited for it: ask for "
         "integrator photon-progressive, which finds such light, or give these emitters a size, as a small sphere or disk";
}

}  // namespace fluxfarm
