// Colours at the vertices of a mesh, interpolated over its triangles; as Mitsuba's `mesh_attribute`.
#include "textures/texture_factories.h"

namespace fluxfarm {
namespace {

class MeshAttribute final : public Texture {
 public:
  explicit MeshAttribute(const MeshAttributeDescription& d) : scale_(d.scale) {}

  Rgb value(const TexturePoint& point) const override { return point.vertex_color * scale_; }
  Rgb mean_value() const override { return Rgb{0.5f * scale_}; }  // of no mesh in particular

 private:
  float scale_;
};

}  // namespace

std::unique_ptr<Texture> make_mesh_attribute(const MeshAttributeDescription& d) { return std::make_unique<MeshAttribute>(d); }

}  // namespace fluxfarm
