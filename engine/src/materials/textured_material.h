// A material that varies over the surface: gives the Bsdf at a hit.
//
// Materials of constant colours have no TexturedMaterial: their one Bsdf serves every point, at no cost for textures.
#pragma once

#include <cstddef>
#include <memory>
#include <new>
#include <utility>

#include "materials/bsdf.h"
#include "support/error.h"
#include "textures/texture.h"

namespace fluxfarm {

// Room for the Bsdfs made at a hit, one or several that hold each other. Bsdfs that own nothing may end without their destructor.
class BsdfSpace {
 public:
  // Throws SceneError when the room is full: make_textured_materials() tries every material, so no hit of a scene does.
  template <class B, class... Arguments>
  const Bsdf& make(Arguments&&... arguments) {
    static_assert(sizeof(B) <= kEach && alignof(B) <= alignof(std::max_align_t));
    std::byte* place = bytes_ + used_;
    used_ += (sizeof(B) + alignof(std::max_align_t) - 1) / alignof(std::max_align_t) * alignof(std::max_align_t);
    if (used_ > sizeof(bytes_)) throw SceneError("materials", "too many materials hold each other, expected less nesting");
    return *new (place) B(std::forward<Arguments>(arguments)...);
  }
  void clear() { used_ = 0; }

 private:
  static constexpr std::size_t kEach = 128;

  std::size_t used_;  // without a value until the first clear(): scenes without textures never touch it
  alignas(std::max_align_t) std::byte bytes_[1024];
};

// A place of a surface, as materials that vary over it need to know it.
struct MaterialPoint {
  TexturePoint texture;
  // Set only for materials with a bump map, or a normal map that asks for v: derivatives of the position by u and v, m, and the
  // geometric normal, all in the frame of the shading normal.
  Vec3f dp_du{}, dp_dv{}, geometric_normal{0, 0, 1};
};

class TexturedMaterial {
 public:
  virtual ~TexturedMaterial() = default;

  // The Bsdf at that point, valid while this material lives and until `space` is used again. It answers the questions that are not
  // about directions (has_continuous_lobe ...) as the constant Bsdf of the same description does.
  const Bsdf& at(const MaterialPoint& point, BsdfSpace& space) const {
    space.clear();
    return add_to(space, point);
  }

  // The same in a space that keeps what it has, for materials that hold others. Makes the same classes at every point.
  virtual const Bsdf& add_to(BsdfSpace& space, const MaterialPoint& point) const = 0;
};

}  // namespace fluxfarm
