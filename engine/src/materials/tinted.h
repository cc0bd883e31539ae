// A textured BSDF whose colours are factors of its reflected and its transmitted light: the constant one, tinted at each hit.
#pragma once

#include <memory>

#include "materials/textured_material.h"
#include "textures/texture.h"

namespace fluxfarm {

// Borrows everything. `reflected` and `transmitted` multiply what `base` scatters to the side of wo and to the other side; null for
// a factor of one. The albedo needs the two parts of `base` by themselves: null for a base that does not transmit.
struct TintedDescription {
  const Bsdf* base = nullptr;
  const Texture* reflected = nullptr;
  const Texture* transmitted = nullptr;
};

std::unique_ptr<TexturedMaterial> make_tinted(const TintedDescription& description, std::unique_ptr<Bsdf> reflecting_part,
                                              std::unique_ptr<Bsdf> transmitting_part);

}  // namespace fluxfarm
