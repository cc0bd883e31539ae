#include "io/read_medium.h"

#include "io/properties.h"
#include "io/text.h"
#include "support/error.h"

namespace fluxfarm {
namespace {

// Of a medium that scatters, m^-1. Thinner, its collisions would lie beyond what rays can reach.
constexpr float kLeastExtinction = 1e-12f;

float albedo_of(float absorbed, float scattered) { return absorbed + scattered > 0 ? scattered / (absorbed + scattered) : 0.0f; }

// By extinction and albedo as in Mitsuba 3, or by absorption and scattering as files of Mitsuba 0.6 may have it.
void read_coefficients(Properties& properties, HomogeneousMediumDescription& medium) {
  const bool absorbs = properties.has("sigma_a"), scatters = properties.has("sigma_s");
  const char* given = absorbs ? "sigma_a" : "sigma_s";
  if (absorbs != scatters) properties.fail(given, "but sigma_a and sigma_s must be given together");
  if (absorbs && (properties.has("sigma_t") || properties.has("albedo"))) {
    properties.fail(given, "but sigma_t or albedo are given, too; expected sigma_t and albedo, or sigma_a and sigma_s");
  }
  if (absorbs) {
    const Rgb a = properties.rgb("sigma_a", {}, kNotNegative), s = properties.rgb("sigma_s", {}, kNotNegative);
    medium.sigma_t = a + s;
    medium.albedo = {albedo_of(a.r, s.r), albedo_of(a.g, s.g), albedo_of(a.b, s.b)};
  } else {
    medium.sigma_t = properties.rgb("sigma_t", Rgb(1), kNotNegative);
    medium.albedo = properties.rgb("albedo", Rgb(0.75f), kUnitInterval);
  }
  medium.sigma_t *= properties.number("scale", 1, kNotNegative);
  if (!is_finite(medium.sigma_t)) properties.fail("scale", "with it the extinction becomes infinite");
  for (const float extinction : {medium.sigma_t.r, medium.sigma_t.g, medium.sigma_t.b}) {
    if (medium.albedo.is_black() || extinction == 0 || extinction >= kLeastExtinction) continue;
    properties.fail(absorbs ? given : "sigma_t", "with scale an extinction of " + number_text(extinction) +
                                                     ", expected 0 or at least " + number_text(kLeastExtinction));
  }
}

}  // namespace

int MediumReader::read(const PluginNode& medium_or_reference) {
  const PluginNode& node = medium_or_reference.kind == PluginKind::kReference
                               ? referenced(medium_or_reference, PluginKind::kMedium, plugins_)
                               : medium_or_reference;
  if (const auto known = indices_.find(&node); known != indices_.end()) return known->second;
  media_.push_back(read_homogeneous(node));
  return indices_[&node] = static_cast<int>(media_.size()) - 1;
}

HomogeneousMediumDescription MediumReader::read_homogeneous(const PluginNode& node) {
  Properties properties(node);
  HomogeneousMediumDescription medium;
  read_coefficients(properties, medium);
  properties.ignore({"sample_emitters", "has_spectral_extinction"});
  properties.finish();
  medium.asymmetry = read_asymmetry(node);
  return medium;
}

// Isotropic without a phase function, as in Mitsuba.
float MediumReader::read_asymmetry(const PluginNode& medium) {
  const PluginNode* phase = nullptr;
  for (const PluginNode& child : medium.children) {
    const bool fits = child.kind == PluginKind::kPhase || child.kind == PluginKind::kReference;
    if (!fits || phase != nullptr) fail_nested(medium, child, "one phase function");
    phase = child.kind == PluginKind::kReference ? &referenced(child, PluginKind::kPhase, plugins_) : &child;
  }
  return phase != nullptr ? read_phase(*phase) : 0.0f;
}

float read_phase(const PluginNode& phase) {
  check_no_children(phase);
  Properties properties(phase);
  const float g = phase.type == "hg" ? properties.number("g", 0.8f, {-1, 1, true}) : 0.0f;
  if (g <= -1 || g >= 1) properties.fail("g", "rounds to an end of its interval, expected a number in (-1, 1)");
  properties.finish();
  return g;
}

bool is_medium_of_shape(const PluginNode& child) {
  if (child.kind == PluginKind::kMedium) return true;
  return child.kind == PluginKind::kReference && (child.name == "interior" || child.name == "exterior");
}

}  // namespace fluxfarm
