#include "textures/make_texture.h"

#include "textures/texture_factories.h"

namespace fluxfarm {
namespace {

struct Maker {
  std::unique_ptr<Texture> operator()(const CheckerboardDescription& d) const { return make_checkerboard(d); }
  std::unique_ptr<Texture> operator()(const BitmapDescription& d) const { return make_bitmap(d); }
  std::unique_ptr<Texture> operator()(const MeshAttributeDescription& d) const { return make_mesh_attribute(d); }
};

}  // namespace

Textures make_textures(const std::vector<TextureDescription>& descriptions) {
  Textures textures;
  textures.reserve(descriptions.size());
  for (const TextureDescription& d : descriptions) textures.push_back(std::visit(Maker{}, d));
  return textures;
}

}  // namespace fluxfarm
