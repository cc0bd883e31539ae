// From the description of a material to the Bsdf that carries it out.
#pragma once

#include <memory>
#include <vector>

#include "materials/bsdf.h"
#include "materials/material_description.h"

namespace fluxfarm {

// One Bsdf for each description, in the same order. References (twosided) point to earlier or later entries of the same vector.
std::vector<std::unique_ptr<Bsdf>> make_bsdfs(const std::vector<MaterialDescription>& descriptions);

}  // namespace fluxfarm
