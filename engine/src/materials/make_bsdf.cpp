#include "materials/make_bsdf.h"

#include <string>

#include "materials/bsdf_factories.h"
#include "support/error.h"

namespace fluxfarm {
namespace {

// Everything but twosided, which needs the others: null for it.
struct Maker {
  std::unique_ptr<Bsdf> operator()(const DiffuseDescription& d) const { return make_diffuse(d); }
  std::unique_ptr<Bsdf> operator()(const DielectricDescription& d) const { return make_dielectric(d); }
  std::unique_ptr<Bsdf> operator()(const ConductorDescription& d) const { return make_conductor(d); }
  std::unique_ptr<Bsdf> operator()(const RoughConductorDescription& d) const { return make_rough_conductor(d); }
  std::unique_ptr<Bsdf> operator()(const RoughDielectricDescription& d) const { return make_rough_dielectric(d); }
  std::unique_ptr<Bsdf> operator()(const PlasticDescription& d) const { return make_plastic(d); }
  std::unique_ptr<Bsdf> operator()(const RoughPlasticDescription& d) const { return make_rough_plastic(d); }
  std::unique_ptr<Bsdf> operator()(const GltfDescription& d) const { return make_gltf(d); }
  std::unique_ptr<Bsdf> operator()(const TwosidedDescription&) const { return nullptr; }
};

const Bsdf& side_of_twosided(const std::vector<std::unique_ptr<Bsdf>>& bsdfs, const std::vector<MaterialDescription>& descriptions,
                             std::size_t material, const char* side, int index) {
  const std::string where = "materials[" + std::to_string(material) + "]." + side;
  if (index < 0 || static_cast<std::size_t>(index) >= bsdfs.size()) {
    throw SceneError(where, std::to_string(index) + ", expected an index below " + std::to_string(bsdfs.size()));
  }
  const auto i = static_cast<std::size_t>(index);
  if (std::holds_alternative<TwosidedDescription>(descriptions[i])) {
    throw SceneError(where, std::to_string(index) + " is twosided itself, expected a one-sided material");
  }
  if (bsdfs[i]->transmits()) throw SceneError(where, std::to_string(index) + " transmits light, expected a material that does not");
  return *bsdfs[i];
}

}  // namespace

std::vector<std::unique_ptr<Bsdf>> make_bsdfs(const std::vector<MaterialDescription>& descriptions) {
  std::vector<std::unique_ptr<Bsdf>> bsdfs;
  bsdfs.reserve(descriptions.size());
  for (const MaterialDescription& d : descriptions) bsdfs.push_back(std::visit(Maker{}, d));
  for (std::size_t i = 0; i < descriptions.size(); ++i) {
    const auto* twosided = std::get_if<TwosidedDescription>(&descriptions[i]);
    if (!twosided) continue;
    const Bsdf& front = side_of_twosided(bsdfs, descriptions, i, "front", twosided->front);
    const Bsdf& back = side_of_twosided(bsdfs, descriptions, i, "back", twosided->back);
    bsdfs[i] = make_twosided(front, back);
  }
  return bsdfs;
}

}  // namespace fluxfarm
