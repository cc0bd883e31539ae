// What a pilot has prepared and rendered by the method that was chosen: the first passes of the picture, so that none is prepared
// twice, those of its tiles that are cut as the picture's, and the audit that its error goal asks for.
#pragma once

#include <algorithm>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "film/light_audit.h"
#include "film/tile_sums.h"
#include "integrators/integrator.h"

namespace fluxfarm {

class PilotSamples {
 public:
  PilotSamples() = default;
  explicit PilotSamples(std::uint64_t seed) : seed_(seed) {}

  void keep(SampleRange samples, std::shared_ptr<const PreparedPass> pass) { passes_.emplace_back(samples, std::move(pass)); }
  void keep(TileSums tile) { tiles_.push_back(std::move(tile)); }
  void keep(LightAudit audit) { audit_ = std::move(audit); }
  void drop_tiles() { tiles_.clear(); }

  // What the method prepared for these samples, null if it needs nothing; empty: the pilot has not prepared them.
  std::optional<std::shared_ptr<const PreparedPass>> pass(std::uint64_t seed, SampleRange samples) const {
    const auto found = std::ranges::find(passes_, samples, &std::pair<SampleRange, std::shared_ptr<const PreparedPass>>::first);
    if (seed != seed_ || found == passes_.end()) return std::nullopt;
    return found->second;
  }
  // Whether it may have some of these samples.
  bool may_have(SampleRange samples) const { return !passes_.empty() && samples.begin < passes_.back().first.end; }
  // Null: not rendered.
  const TileSums* tile(std::uint64_t seed, SampleRange samples, PixelRect rect) const {
    const auto found = std::ranges::find_if(tiles_, [&](const TileSums& t) { return t.samples == samples && t.rect == rect; });
    return seed != seed_ || found == tiles_.end() ? nullptr : &*found;
  }
  // Null: not made, or another one than the method's.
  const LightAudit* audit(std::uint64_t seed) const { return seed == seed_ && audit_ ? &*audit_ : nullptr; }

 private:
  std::uint64_t seed_ = 0;
  std::vector<std::pair<SampleRange, std::shared_ptr<const PreparedPass>>> passes_;
  std::vector<TileSums> tiles_;
  std::optional<LightAudit> audit_;
};

}  // namespace fluxfarm
