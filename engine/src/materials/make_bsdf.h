// From the description of a material to the Bsdf that carries it out.
#pragma once

#include <memory>
#include <vector>

#include "materials/bsdf.h"
#include "materials/material_description.h"

namespace fluxfarm {

// One Bsdf for each description, in the same order. What a material holds (twosided, mask, ...) are
// earlier or later entries of the same vector. Throws SceneError for an index that means nothing, and for one that contains itself.
std::vector<std::unique_ptr<Bsdf>> make_bsdfs(const std::vector<MaterialDescription>& descriptions);

}  // namespace fluxfarm
