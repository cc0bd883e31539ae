// A material whose colours vary over the surface: gives the Bsdf at a hit.
//
// Materials of constant colours have no TexturedMaterial: their one Bsdf serves every point, at no cost for textures.
#pragma once

#include <cstddef>
#include <memory>
#include <new>
#include <utility>

#include "materials/bsdf.h"

namespace fluxfarm {

// Room for one Bsdf made at a hit; the next one takes its place. Bsdfs that own nothing may end without their destructor.
class BsdfSpace {
 public:
  template <class B, class... Arguments>
  const Bsdf& make(Arguments&&... arguments) {
    static_assert(sizeof(B) <= sizeof(bytes_) && alignof(B) <= alignof(std::max_align_t));
    return *new (bytes_) B(std::forward<Arguments>(arguments)...);
  }

 private:
  alignas(std::max_align_t) std::byte bytes_[112];
};

class TexturedMaterial {
 public:
  virtual ~TexturedMaterial() = default;

  // The Bsdf at texture coordinates uv, valid while this material lives and until `space` is used again. It answers the questions
  // that are not about directions (has_continuous_lobe ...) as the constant Bsdf of the same description does.
  virtual const Bsdf& at(Vec2f uv, BsdfSpace& space) const = 0;
};

}  // namespace fluxfarm
