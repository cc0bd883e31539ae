// glTF's metallic-roughness surface: diffuse or transmitting base under Schlick-Fresnel GGX, or metal; then sheen; then a clear
// coat.
//
//   dielectric = (1 - t) N base / pi + t (1 - max F_d) base T + F_d S      F_d = Schlick from the index of refraction and
//   `specular` metal      = F_m S                                                     F_m = Schlick from the base colour f = (1 - c
//   F_c(wo)) (1 - c F_c(wi)) [sheen + E (mix(dielectric, metal, metallic))] + c F_c S_c
//
// S and S_c are GGX with separable Smith, T its refraction (a volume) or the mirror image of S (a thin pane), E what sheen leaves,
// N = (1 - max F_d(wo)) (1 - max F_d(wi)) / (1 - mean max F_d) what a smooth interface leaves to a diffuse base [Kelemen01].
// Both sides scatter alike, but for the inside of a volume, which has neither coat nor sheen. Where it differs from [glTF]: N
// stands there for 1 - max F_d at the microfacet, which gains up to 29 % of energy at grazing angles; the coat and sheen dim what
// is below on the way in and out alike, so that the BSDF is reciprocal; the interface of a volume has the exact Fresnel
// reflectance, since Schlick's knows no total reflection. Single scattering: loses energy with roughness.
//
// [glTF]     Khronos, "glTF 2.0 Specification", appendix B, and the KHR_materials_* extensions.
// [Kelemen01] C. Kelemen and L. Szirmay-Kalos, "A Microfacet Based Coupled Specular-Matte BRDF Model with Importance Sampling",
//            Eurographics 2001 short presentations.
// [Schlick94] C. Schlick, "An Inexpensive BRDF Model for Physically-based Rendering", Eurographics 1994.
// [Walter07] B. Walter et al., "Microfacet Models for Refraction through Rough Surfaces", EGSR 2007.
#include "materials/bsdf_factories.h"
#include "materials/charlie_sheen.h"
#include "materials/directions.h"
#include "materials/fresnel.h"
#include "materials/ggx.h"
#include "materials/textured_factories.h"

namespace fluxfarm {
namespace {

constexpr float kCoatF0 = 0.04f;  // index 1.5

float schlick_weight(float cosine) {
  const float c = std::min(std::max(1 - cosine, 0.0f), 1.0f);
  return sqr(sqr(c)) * c;
}
float coat_fresnel(float cosine) { return kCoatF0 + (1 - kCoatF0) * schlick_weight(cosine); }

Rgb min(Rgb a, float b) { return {std::min(a.r, b), std::min(a.g, b), std::min(a.b, b)}; }

class Gltf final : public Bsdf {
 public:
  explicit Gltf(const GltfDescription& d)
      : base_(d.base_color),
        metallic_(d.metallic),
        microfacets_(sqr(d.roughness) + (1 - sqr(d.roughness)) * sqr(d.anisotropy), sqr(d.roughness)),
        rotation_{std::cos(d.anisotropy_rotation), std::sin(d.anisotropy_rotation)},
        ior_(d.ior),
        transmission_(d.transmission),
        specular_(d.specular),
        specular_color_(d.specular_color),
        coat_(d.clearcoat),
        coat_alpha_(sqr(d.clearcoat_roughness)),
        sheen_(d.sheen_color),
        sheen_roughness_(d.sheen_roughness),
        thin_(d.thin) {}

  BsdfValue value(const Vec3f& surface_wo, const Vec3f& surface_wi) const override {
    if (surface_wo.z == 0 || surface_wi.z == 0) return {};
    const Vec3f wo = turned(surface_wo), wi = turned(surface_wi);
    const Lobes lobes = lobes_at(wo);
    const float below = beneath_coat(wo) * beneath_coat(wi);
    if ((wo.z > 0) != (wi.z > 0)) {
      if (lobes.transmission <= 0) return {};
      BsdfValue v = transmitted(wo, wi);
      v.f *= below * sheen_leaves(wo, wi);
      v.pdf *= lobes.transmission;
      return v;
    }
    return reflected(wo, wi, lobes, below);
  }

  std::optional<BsdfSample> sample(const Vec3f& surface_wo, float u_lobe, Vec2f u) const override {
    if (surface_wo.z == 0) return std::nullopt;
    const Vec3f wo = turned(surface_wo);
    const Lobes lobes = lobes_at(wo);
    float eta = 1;
    const std::optional<Vec3f> wi = direction(wo, lobes, u_lobe, u, eta);
    if (!wi || wi->z == 0) return std::nullopt;
    const Vec3f surface_wi = turned_back(*wi);
    const BsdfValue v = value(surface_wo, surface_wi);
    if (!(v.pdf > 0)) return std::nullopt;
    return BsdfSample{.wi = surface_wi, .weight = v.f * (std::abs(wi->z) / v.pdf), .pdf = v.pdf, .eta = eta};
  }

  // From the reflectances at wo's own angle: as if all surfaces were smooth, within 0.1 at roughnesses below one half.
  Rgb albedo(const Vec3f& wo) const override {
    const float cosine = std::abs(wo.z);
    const Rgb dielectric = dielectric_fresnel(cosine, wo.z > 0);
    const Rgb base = dielectric + base_ * (1 - max_component(dielectric));
    const Rgb below = base * (1 - metallic_) + metal_fresnel(cosine) * metallic_;
    const float coat = coat_ * coat_fresnel(cosine), sheen = has_sheen() ? sheen_albedo(cosine) : 0.0f;
    const Rgb sheened = sheen_ * std::min(sheen, 1.0f) + below * std::max(1 - max_component(sheen_) * sheen, 0.0f);
    return sheened * sqr(1 - coat) + Rgb{coat};
  }

  bool has_continuous_lobe() const override { return true; }
  bool transmits() const override { return transmission_ > 0 && metallic_ < 1; }

 private:
  // Probabilities of the lobes seen from wo; they add up to one.
  struct Lobes {
    float coat, specular, transmission, sheen, diffuse;
  };

  bool is_inside(const Vec3f& w) const { return w.z < 0 && !thin_; }
  bool has_exact_fresnel() const { return transmits() && !thin_; }
  bool has_sheen() const { return !sheen_.is_black(); }

  // Into the frame of the anisotropy and back.
  Vec3f turned(const Vec3f& w) const { return {rotation_.x * w.x + rotation_.y * w.y, rotation_.x * w.y - rotation_.y * w.x, w.z}; }
  Vec3f turned_back(const Vec3f& w) const {
    return {rotation_.x * w.x - rotation_.y * w.y, rotation_.x * w.y + rotation_.y * w.x, w.z};
  }

  Rgb metal_fresnel(float cosine) const { return base_ + (Rgb{1} - base_) * schlick_weight(cosine); }
  // Of the dielectric part, as seen from outside or from within.
  Rgb dielectric_fresnel(float cosine, bool outside) const {
    if (ior_ == 0) return Rgb{1};
    if (has_exact_fresnel()) {
      return min(specular_color_ * fresnel_dielectric(outside ? cosine : -cosine, ior_).reflectance, 1) * specular_;
    }
    const Rgb f0 = min(specular_color_ * sqr((1 - ior_) / (1 + ior_)), 1);
    return (f0 + (Rgb{1} - f0) * schlick_weight(cosine)) * specular_;
  }

  // N above.                                                                                              [Kelemen01]
  float left_to_diffuse(float cos_o, float cos_i, bool outside) const {
    const float left =
        (1 - max_component(dielectric_fresnel(cos_o, outside))) * (1 - max_component(dielectric_fresnel(cos_i, outside)));
    if (ior_ == 0 || has_exact_fresnel()) return left;  // without the mean, which has no closed form: a little too dark
    const float f0 = max_component(min(specular_color_ * sqr((1 - ior_) / (1 + ior_)), 1));
    const float mean = (f0 + (1 - f0) / 21) * specular_;  // Schlick's, weighted by the cosine
    return mean < 1 ? left / (1 - mean) : 0.0f;
  }

  float beneath_coat(const Vec3f& w) const { return is_inside(w) ? 1.0f : 1 - coat_ * coat_fresnel(std::abs(w.z)); }

  float sheen_albedo(float cosine) const { return CharlieAlbedo::table()(cosine, sheen_roughness_); }
  float sheen_leaves(const Vec3f& wo, const Vec3f& wi) const {
    if (!has_sheen()) return 1;
    const float most = max_component(sheen_) * std::max(sheen_albedo(std::abs(wo.z)), sheen_albedo(std::abs(wi.z)));
    return std::max(1 - most, 0.0f);
  }

  Lobes lobes_at(const Vec3f& wo) const {
    const float cosine = std::abs(wo.z);
    const float coat = is_inside(wo) ? 0.0f : coat_ * coat_fresnel(cosine);
    const Rgb dielectric = dielectric_fresnel(cosine, wo.z > 0);
    // Tilted microfacets let light through also where the smooth surface reflects all.
    const float base = luminance(base_) * (1 - metallic_) * std::max(1 - max_component(dielectric), 0.1f);
    const float specular = luminance(dielectric) * (1 - metallic_) + luminance(metal_fresnel(cosine)) * metallic_;
    const float sheen = has_sheen() ? luminance(sheen_) : 0.0f;
    Lobes lobes{coat, (1 - coat) * specular, (1 - coat) * base * transmission_, (1 - coat) * sheen,
                (1 - coat) * base * (1 - transmission_)};
    const float sum = lobes.coat + lobes.specular + lobes.transmission + lobes.sheen + lobes.diffuse;
    if (!(sum > 0)) return {0, 1, 0, 0, 0};
    const float scale = 1 / sum;
    return {lobes.coat * scale, lobes.specular * scale, lobes.transmission * scale, lobes.sheen * scale, lobes.diffuse * scale};
  }

  // Both on one side.
  BsdfValue reflected(const Vec3f& wo, const Vec3f& wi, const Lobes& lobes, float below) const {
    const float side = wo.z > 0 ? 1.0f : -1.0f;
    const Vec3f o = wo * side, i = wi * side;
    const std::optional<Vec3f> m = half_vector(o, i, 1);
    if (!m) return {};
    const float cosine = dot(o, *m), leaves = sheen_leaves(o, i);
    const Rgb dielectric = dielectric_fresnel(cosine, wo.z > 0);
    BsdfValue v;
    // Base: metal and dielectric share their microfacets.
    const float d = microfacets_.normal_density(*m), shape = 0.25f * d * microfacets_.masking_by_cosine(o);
    const Rgb fresnel = dielectric * (1 - metallic_) + metal_fresnel(cosine) * metallic_;
    v.f = fresnel * (shape * microfacets_.masking_by_cosine(i) * leaves);
    v.f += base_ * (left_to_diffuse(o.z, i.z, wo.z > 0) * (1 - transmission_) * (1 - metallic_) * kInvPi * leaves);
    v.pdf = lobes.specular * shape + (lobes.diffuse + lobes.sheen) * i.z * kInvPi;
    if (has_sheen() && !is_inside(wo)) {
      const float bound = std::max({1.0f, sheen_albedo(o.z), sheen_albedo(i.z)});
      v.f += sheen_ * (charlie_sheen(charlie_alpha(sheen_roughness_), o.z, i.z, m->z) / bound);
    }
    v.f *= below;
    if (coat_ > 0 && !is_inside(wo)) {
      const Ggx coat(coat_alpha_, coat_alpha_);
      const float coat_shape = 0.25f * coat.normal_density(*m) * coat.masking_by_cosine(o);
      v.f += Rgb{coat_ * coat_fresnel(cosine) * coat_shape * coat.masking_by_cosine(i)};
      v.pdf += lobes.coat * coat_shape;
    }
    return v;
  }

  // wo and wi on different sides; the pdf is that of the lobe alone.
  BsdfValue transmitted(const Vec3f& wo, const Vec3f& wi) const {
    if (thin_) {
      const float side = wo.z > 0 ? 1.0f : -1.0f;
      const Vec3f o = wo * side, mirrored{wi.x * side, wi.y * side, -wi.z * side};
      const std::optional<Vec3f> m = half_vector(o, mirrored, 1);
      if (!m) return {};
      const float shape = 0.25f * microfacets_.normal_density(*m) * microfacets_.masking_by_cosine(o);
      return {passed(dot(o, *m), true) * (shape * microfacets_.masking_by_cosine(mirrored)), shape};
    }
    const float eta = wo.z > 0 ? ior_ : 1 / ior_;
    const std::optional<Vec3f> m = half_vector(wo, wi, eta);
    if (!m) return {};
    const float cos_o = dot(wo, *m), cos_i = dot(wi, *m), root = cos_o + eta * cos_i;
    if (cos_o * wo.z <= 0 || cos_i * wi.z <= 0) return {};
    // As in rough_dielectric.cpp, where the Jacobian is derived.                                              [Walter07]
    const float jacobian = microfacets_.normal_density(*m) * std::abs(cos_o * cos_i) / (root * root);
    if (!(jacobian <= 1e30f)) return {};
    const float masking = microfacets_.masking_by_cosine(wo);
    return {passed(std::abs(cos_o), wo.z > 0) * (jacobian * masking * microfacets_.masking_by_cosine(wi)),
            jacobian * masking * eta * eta};
  }

  // Share of the light that passes a microfacet.
  Rgb passed(float cosine, bool outside) const {
    return base_ * ((1 - max_component(dielectric_fresnel(cosine, outside))) * transmission_ * (1 - metallic_));
  }

  // A direction of one lobe; `eta` is set where it refracts. Empty: none.
  std::optional<Vec3f> direction(const Vec3f& wo, const Lobes& lobes, float u_lobe, Vec2f u, float& eta) const {
    const float side = wo.z > 0 ? 1.0f : -1.0f;
    const Vec3f o = wo * side;
    if ((u_lobe -= lobes.coat) < 0) return mirrored_on(Ggx(coat_alpha_, coat_alpha_), o, side, u);
    if ((u_lobe -= lobes.specular) < 0) return mirrored_on(microfacets_, o, side, u);
    if ((u_lobe -= lobes.transmission) < 0) {
      if (thin_) {
        const std::optional<Vec3f> wi = mirrored_on(microfacets_, o, side, u);
        return wi ? std::optional(Vec3f{wi->x, wi->y, -wi->z}) : std::nullopt;
      }
      const Vec3f m = microfacets_.sample_normal(o, u);
      const float cosine = dot(wo, m);
      const DielectricFresnel fresnel = fresnel_dielectric(cosine, ior_);
      if (fresnel.cos_t == 0 || cosine * wo.z <= 0) return std::nullopt;
      const Vec3f wi = refract(wo, m, cosine, fresnel.cos_t, fresnel.eta);
      if (wi.z * wo.z >= 0) return std::nullopt;
      eta = fresnel.eta;
      return wi;
    }
    return square_to_cosine_hemisphere(u) * side;
  }

  static std::optional<Vec3f> mirrored_on(const Ggx& microfacets, Vec3f o, float side, Vec2f u) {
    const Vec3f m = microfacets.sample_normal(o, u);
    const float cosine = dot(o, m);
    const Vec3f i = reflect(o, m, cosine);
    if (cosine <= 0 || i.z <= 0) return std::nullopt;
    return i * side;
  }

  Rgb base_;
  float metallic_;
  Ggx microfacets_;
  Vec2f rotation_;  // cosine and sine
  float ior_, transmission_, specular_;
  Rgb specular_color_;
  float coat_, coat_alpha_;
  Rgb sheen_;
  float sheen_roughness_;
  bool thin_;
};

class TexturedGltf final : public TexturedMaterial {
 public:
  TexturedGltf(const GltfDescription& d, const Textures& textures)
      : d_(d),
        base_color_(texture_of(textures, d.base_color_texture)),
        metallic_roughness_(texture_of(textures, d.metallic_roughness_texture)),
        transmission_(texture_of(textures, d.transmission_texture)),
        specular_(texture_of(textures, d.specular_texture)),
        specular_color_(texture_of(textures, d.specular_color_texture)),
        clearcoat_(texture_of(textures, d.clearcoat_texture)),
        clearcoat_roughness_(texture_of(textures, d.clearcoat_roughness_texture)),
        sheen_color_(texture_of(textures, d.sheen_color_texture)),
        sheen_roughness_(texture_of(textures, d.sheen_roughness_texture)) {}

  const Bsdf& add_to(BsdfSpace& space, const MaterialPoint& point) const override {
    const TexturePoint& at = point.texture;
    GltfDescription d = d_;
    d.base_color = colour_at(d.base_color, base_color_, at);
    if (d.vertex_colors) d.base_color *= at.vertex_color;
    if (metallic_roughness_ != nullptr) {
      const Rgb texel = metallic_roughness_->value(at);
      d.roughness *= texel.g;
      d.metallic *= texel.b;
    }
    if (transmission_ != nullptr) d.transmission *= transmission_->value(at).r;
    if (specular_ != nullptr) d.specular *= specular_->value(at).r;
    d.specular_color = colour_at(d.specular_color, specular_color_, at);
    if (clearcoat_ != nullptr) d.clearcoat *= clearcoat_->value(at).r;
    if (clearcoat_roughness_ != nullptr) d.clearcoat_roughness *= clearcoat_roughness_->value(at).g;
    d.sheen_color = colour_at(d.sheen_color, sheen_color_, at);
    if (sheen_roughness_ != nullptr) d.sheen_roughness *= sheen_roughness_->value(at).r;
    return space.make<Gltf>(d);
  }

 private:
  GltfDescription d_;
  const Texture* base_color_;
  const Texture* metallic_roughness_;
  const Texture* transmission_;
  const Texture* specular_;
  const Texture* specular_color_;
  const Texture* clearcoat_;
  const Texture* clearcoat_roughness_;
  const Texture* sheen_color_;
  const Texture* sheen_roughness_;
};

bool varies(const GltfDescription& d) {
  const int used[] = {d.base_color_texture,     d.metallic_roughness_texture, d.transmission_texture,        d.specular_texture,
                      d.specular_color_texture, d.clearcoat_texture,          d.clearcoat_roughness_texture, d.sheen_color_texture,
                      d.sheen_roughness_texture};
  return d.vertex_colors || std::any_of(std::begin(used), std::end(used), [](int texture) { return texture != kNoTexture; });
}

}  // namespace

std::unique_ptr<Bsdf> make_gltf(const GltfDescription& d) { return std::make_unique<Gltf>(d); }

std::unique_ptr<TexturedMaterial> make_textured_gltf(const GltfDescription& d, const Textures& textures) {
  return varies(d) ? std::make_unique<TexturedGltf>(d, textures) : nullptr;
}

}  // namespace fluxfarm
