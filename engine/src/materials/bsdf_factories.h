// One function for each BSDF. The classes themselves live in the .cpp file of the same name; make_bsdf.h is the way in from
// outside.
#pragma once

#include <memory>

#include "materials/bsdf.h"
#include "materials/material_description.h"

namespace fluxfarm {

std::unique_ptr<Bsdf> make_diffuse(const DiffuseDescription&);
std::unique_ptr<Bsdf> make_dielectric(const DielectricDescription&);
std::unique_ptr<Bsdf> make_conductor(const ConductorDescription&);
std::unique_ptr<Bsdf> make_rough_conductor(const RoughConductorDescription&);
std::unique_ptr<Bsdf> make_rough_dielectric(const RoughDielectricDescription&);
std::unique_ptr<Bsdf> make_plastic(const PlasticDescription&);
std::unique_ptr<Bsdf> make_rough_plastic(const RoughPlasticDescription&);
std::unique_ptr<Bsdf> make_gltf(const GltfDescription&);
std::unique_ptr<Bsdf> make_principled(const PrincipledDescription&);

std::unique_ptr<Bsdf> make_thin_dielectric(const ThinDielectricDescription&);
std::unique_ptr<Bsdf> make_null();

// These borrow what they hold: it must outlive the result.
std::unique_ptr<Bsdf> make_mask(const Bsdf& covered, float opacity, std::optional<float> cutoff);
std::unique_ptr<Bsdf> make_blend(const Bsdf& first, const Bsdf& second, float weight);

// Borrows both sides: they must outlive the result and must not transmit.
std::unique_ptr<Bsdf> make_twosided(const Bsdf& front, const Bsdf& back);

}  // namespace fluxfarm
