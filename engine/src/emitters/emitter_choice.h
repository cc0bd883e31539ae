// Which emitter next-event estimation asks at a place.
//
// With one emitter there is nothing to choose. With more, those inside the scene stand in an EmitterTree, the triangles of an
// emitting mesh each by itself, and are chosen by what they may bring to the place. Light from outside has no place: each such
// emitter, and the tree as a whole, has a share of its own, half evenly, half in proportion to power. A lone mesh of many triangles
// counts as many emitters.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "emitters/emitter.h"
#include "emitters/emitter_tree.h"
#include "emitters/triangle_emitter.h"
#include "math/ray.h"
#include "sampling/discrete_distribution.h"

namespace fluxfarm {

class EmitterChoice {
 public:
  // A lone mesh with fewer triangles is chosen from by area, which costs less and serves as well as a tree of a few leaves.
  static constexpr std::size_t kManyTriangles = 64;

  EmitterChoice() = default;
  EmitterChoice(EmitterChoice&&) = default;
  EmitterChoice& operator=(EmitterChoice&&) = default;
  // The emitters must outlive this.
  explicit EmitterChoice(const std::vector<const Emitter*>& emitters);

  bool empty() const { return emitters_.empty(); }
  // With one emitter no random number is needed.
  bool single() const { return emitters_.size() == 1 && candidates_.empty(); }
  // Whether the probabilities depend on the reference.
  bool by_place() const { return tree_.size() > 1; }
  // How many are chosen from: triangles, where those stand by themselves.
  std::size_t candidates() const { return single() ? 1 : candidates_.size() + distant_.size(); }

  struct Choice {
    const Emitter* emitter;
    float probability;
  };
  // Must not be empty; u in [0,1). Empty: none that was asked can bring light there.
  std::optional<Choice> sample(const EmitterReference& reference, float u) const {
    if (single()) return Choice{emitters_.front(), 1.0f};
    return sample_many(reference, u);
  }

  // A point of an emitting shape, as a ray found it.
  struct SeenPoint {
    const SurfacePoint& point;
    const Hit& hit;
    const Ray& ray;  // from the reference, or as close to it as its surface allows
  };
  // Density per solid angle with which sample() followed by the emitter's own sample() finds what was seen. `emitter` is the index
  // of an AreaEmitter in the constructor's list; `reference` is not looked at unless by_place().
  float pdf(std::size_t emitter, const EmitterReference& reference, const SeenPoint& seen) const {
    if (!single()) return pdf_of_many(emitter, reference, seen);
    return static_cast<const AreaEmitter*>(emitters_[emitter])
        ->shape()
        .pdf(seen.ray.origin, seen.point, seen.hit.primitive, seen.ray.direction, seen.hit.t);
  }
  // Probability of choosing an emitter of the constructor's list that lies outside the scene: the same everywhere.
  float distant_probability(std::size_t emitter) const;

 private:
  std::optional<Choice> sample_many(const EmitterReference& reference, float u) const;
  float pdf_of_many(std::size_t emitter, const EmitterReference& reference, const SeenPoint& seen) const;

  std::vector<const Emitter*> emitters_;  // as given
  std::vector<const Emitter*> distant_;
  std::vector<TriangleEmitter> triangles_;
  std::vector<const Emitter*> candidates_;  // those in the tree; a mesh as its triangles
  struct Place {
    std::uint32_t first;  // in the tree, or among the distant ones
    const TriangleMesh* mesh = nullptr;
  };
  std::vector<Place> places_;    // of each of emitters_
  DiscreteDistribution groups_;  // the distant ones in order, then the tree if there is one
  EmitterTree tree_;
};

}  // namespace fluxfarm
