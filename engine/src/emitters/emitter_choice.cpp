#include "emitters/emitter_choice.h"

namespace fluxfarm {
namespace {

const TriangleMesh* mesh_of(const Emitter* emitter) {
  const auto* area = dynamic_cast<const AreaEmitter*>(emitter);
  return area != nullptr ? dynamic_cast<const TriangleMesh*>(&area->shape()) : nullptr;
}

// Half evenly, so that a weak one keeps a chance.
DiscreteDistribution shares(const std::vector<double>& powers) {
  const double count = static_cast<double>(powers.size());
  double total = 0;
  for (const double power : powers) total += power;
  std::vector<double> weights;
  weights.reserve(powers.size());
  for (const double power : powers) weights.push_back(0.5 / count + 0.5 * (total > 0 ? power / total : 1 / count));
  return DiscreteDistribution(weights);
}

}  // namespace

EmitterChoice::EmitterChoice(const std::vector<const Emitter*>& emitters) : emitters_(emitters) {
  if (emitters.empty()) return;
  if (emitters.size() == 1) {
    const TriangleMesh* mesh = mesh_of(emitters.front());
    if (mesh == nullptr || mesh->triangles() < kManyTriangles) return;
  }
  std::vector<double> powers;
  double power_in_tree = 0;
  std::vector<EmitterBounds> bounds;
  std::size_t triangles = 0;
  for (const Emitter* emitter : emitters) {
    if (const TriangleMesh* mesh = mesh_of(emitter)) triangles += mesh->triangles();
  }
  triangles_.reserve(triangles);  // they are pointed to
  for (const Emitter* emitter : emitters) {
    const auto power = static_cast<double>(luminance(emitter->power()));
    if (const TriangleMesh* mesh = mesh_of(emitter)) {
      places_.push_back({static_cast<std::uint32_t>(candidates_.size()), mesh});
      const auto& area = static_cast<const AreaEmitter&>(*emitter);
      for (std::size_t i = 0; i < mesh->triangles(); ++i) {
        triangles_.emplace_back(*mesh, static_cast<std::uint32_t>(i), area.radiance(), area.both_sides());
        candidates_.push_back(&triangles_.back());
        bounds.push_back(*triangles_.back().bounds());
      }
      power_in_tree += power;
    } else if (const std::optional<EmitterBounds> own = emitter->bounds()) {
      places_.push_back({static_cast<std::uint32_t>(candidates_.size())});
      candidates_.push_back(emitter);
      bounds.push_back(*own);
      power_in_tree += power;
    } else {
      places_.push_back({static_cast<std::uint32_t>(distant_.size())});
      distant_.push_back(emitter);
      powers.push_back(power);
    }
  }
  if (!candidates_.empty()) {
    tree_ = EmitterTree(bounds);
    powers.push_back(power_in_tree);
  }
  groups_ = shares(powers);
}

std::optional<EmitterChoice::Choice> EmitterChoice::sample_many(const EmitterReference& reference, float u) const {
  if (distant_.empty()) {
    const std::optional<EmitterTree::Choice> leaf = tree_.sample(reference, u);
    return leaf ? std::optional(Choice{candidates_[leaf->index], leaf->probability}) : std::nullopt;
  }
  const DiscreteDistribution::Choice group = groups_.sample(u);
  if (group.index < distant_.size()) return Choice{distant_[group.index], group.probability};
  const std::optional<EmitterTree::Choice> leaf = tree_.sample(reference, group.u);
  if (!leaf) return std::nullopt;
  return Choice{candidates_[leaf->index], group.probability * leaf->probability};
}

float EmitterChoice::pdf_of_many(std::size_t emitter, const EmitterReference& reference, const SeenPoint& seen) const {
  const auto& [point, hit, ray] = seen;
  const auto& [first, mesh] = places_[emitter];
  const std::size_t leaf = first + (mesh != nullptr ? hit.primitive : 0);
  const float in_tree = distant_.empty() ? 1.0f : groups_.probability(distant_.size());
  const float probability = in_tree * (by_place() ? tree_.probability(reference, leaf) : 1.0f);
  if (!(probability > 0)) return 0;
  const float pdf = mesh != nullptr ? mesh->triangle_pdf(hit.primitive, ray.origin, point, ray.direction, hit.t)
                                    : static_cast<const AreaEmitter*>(emitters_[emitter])
                                          ->shape()
                                          .pdf(ray.origin, point, hit.primitive, ray.direction, hit.t);
  return probability * pdf;
}

float EmitterChoice::distant_probability(std::size_t emitter) const {
  return single() ? 1.0f : groups_.probability(places_[emitter].first);
}

}  // namespace fluxfarm
