#include "materials/make_bsdf.h"

#include <string>

#include "materials/bsdf_factories.h"
#include "materials/perturbed.h"
#include "math/frame.h"
#include "support/error.h"

namespace fluxfarm {
namespace {

// Makes each material after those that it holds, wherever they stand in the list.
class Maker {
 public:
  explicit Maker(const std::vector<MaterialDescription>& descriptions)
      : descriptions_(descriptions), states_(descriptions.size(), State::kUntouched), bsdfs_(descriptions.size()) {}

  std::vector<std::unique_ptr<Bsdf>> make_all() {
    for (std::size_t i = 0; i < descriptions_.size(); ++i) make(i);
    return std::move(bsdfs_);
  }

  std::unique_ptr<Bsdf> operator()(const DiffuseDescription& d) { return make_diffuse(d); }
  std::unique_ptr<Bsdf> operator()(const DielectricDescription& d) { return make_dielectric(d); }
  std::unique_ptr<Bsdf> operator()(const ConductorDescription& d) { return make_conductor(d); }
  std::unique_ptr<Bsdf> operator()(const RoughConductorDescription& d) { return make_rough_conductor(d); }
  std::unique_ptr<Bsdf> operator()(const RoughDielectricDescription& d) { return make_rough_dielectric(d); }
  std::unique_ptr<Bsdf> operator()(const PlasticDescription& d) { return make_plastic(d); }
  std::unique_ptr<Bsdf> operator()(const RoughPlasticDescription& d) { return make_rough_plastic(d); }
  std::unique_ptr<Bsdf> operator()(const PrincipledDescription& d) { return make_principled(d); }
  std::unique_ptr<Bsdf> operator()(const GltfDescription& d) { return make_gltf(d); }
  std::unique_ptr<Bsdf> operator()(const ThinDielectricDescription& d) { return make_thin_dielectric(d); }
  std::unique_ptr<Bsdf> operator()(const NullDescription&) { return make_null(); }
  std::unique_ptr<Bsdf> operator()(const MaskDescription& d) {
    return make_mask(held("material", d.material), d.opacity.factor, d.cutoff);
  }
  std::unique_ptr<Bsdf> operator()(const BlendDescription& d) {
    const Bsdf& first = held("first", d.first);
    return make_blend(first, held("second", d.second), d.weight.factor);
  }
  std::unique_ptr<Bsdf> operator()(const TwosidedDescription& d) {
    const Bsdf& front = side("front", d.front);
    return make_twosided(front, side("back", d.back));
  }
  // Their normals are known at hits only; this one answers the questions that are not about directions.
  std::unique_ptr<Bsdf> operator()(const NormalMapDescription& d) { return untilted(d.material); }
  std::unique_ptr<Bsdf> operator()(const BumpMapDescription& d) { return untilted(d.material); }

 private:
  enum class State { kUntouched, kBeingMade, kMade };

  void make(std::size_t i) {
    if (states_[i] == State::kMade) return;
    if (states_[i] == State::kBeingMade) throw SceneError("materials[" + std::to_string(i) + "]", "contains itself");
    states_[i] = State::kBeingMade;
    const std::size_t outer = current_;
    current_ = i;
    bsdfs_[i] = std::visit(*this, descriptions_[i]);
    current_ = outer;
    states_[i] = State::kMade;
  }

  std::string place(const char* member) const { return "materials[" + std::to_string(current_) + "]." + member; }

  // What the material that is being made holds.
  const Bsdf& held(const char* member, int index) {
    if (index < 0 || static_cast<std::size_t>(index) >= bsdfs_.size()) {
      throw SceneError(place(member), std::to_string(index) + ", expected an index below " + std::to_string(bsdfs_.size()));
    }
    make(static_cast<std::size_t>(index));
    return *bsdfs_[static_cast<std::size_t>(index)];
  }

  const Bsdf& side(const char* member, int index) {
    if (index >= 0 && static_cast<std::size_t>(index) < bsdfs_.size() &&
        std::holds_alternative<TwosidedDescription>(descriptions_[static_cast<std::size_t>(index)])) {
      throw SceneError(place(member), std::to_string(index) + " is twosided itself, expected a one-sided material");
    }
    const Bsdf& bsdf = held(member, index);
    if (bsdf.transmits()) {
      throw SceneError(place(member), std::to_string(index) + " transmits light, expected a material that does not");
    }
    return bsdf;
  }

  std::unique_ptr<Bsdf> untilted(int index) { return std::make_unique<PerturbedBsdf>(held("material", index), Frame()); }

  const std::vector<MaterialDescription>& descriptions_;
  std::vector<State> states_;
  std::vector<std::unique_ptr<Bsdf>> bsdfs_;
  std::size_t current_ = 0;
};

}  // namespace

std::vector<std::unique_ptr<Bsdf>> make_bsdfs(const std::vector<MaterialDescription>& descriptions) {
  return Maker(descriptions).make_all();
}

}  // namespace fluxfarm
