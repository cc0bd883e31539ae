// A SceneDescription as text, so that tests can compare two and show where they differ.
#pragma once

#include <iomanip>
#include <sstream>
#include <string>

#include "scene/description.h"

namespace fluxfarm {

class Describer {
 public:
  std::string describe(const SceneDescription& scene) {
    for (const auto& material : scene.materials) std::visit([this](const auto& m) { write(m); }, material);
    for (const auto& texture : scene.textures) std::visit([this](const auto& t) { write(t); }, texture);
    for (const auto& medium : scene.media) write(medium);
    for (const auto& shape : scene.shapes) {
      out_ << "shape " << shape.name << " material " << shape.material << " flip " << shape.flip_normals << " media "
           << shape.interior_medium << " " << shape.exterior_medium << "\n";
      if (shape.emitted_radiance) write("radiance", *shape.emitted_radiance);
      std::visit([this](const auto& g) { write(g); }, shape.geometry);
    }
    for (const auto& emitter : scene.emitters) std::visit([this](const auto& e) { write(e); }, emitter);
    write("camera", scene.camera.to_world);
    out_ << "in medium " << scene.camera.medium << "\n";
    out_ << "fov " << static_cast<int>(scene.camera.fov_axis) << " " << scene.camera.fov_degrees << " clip "
         << scene.camera.near_clip << " " << scene.camera.far_clip << " lens " << scene.camera.aperture_radius << " "
         << scene.camera.focus_distance << "\nfilm " << scene.film.width << " " << scene.film.height << " crop "
         << scene.film.crop_x << " " << scene.film.crop_y << " " << scene.film.crop_width << " " << scene.film.crop_height
         << " filter " << static_cast<int>(scene.film.filter.kind) << " " << scene.film.filter.radius << " "
         << scene.film.filter.stddev << "\nmethod " << scene.method.integrator << " " << scene.method.max_depth << " "
         << scene.method.rr_depth << " " << scene.method.hide_emitters << " samples " << scene.samples_per_pixel << "\n";
    return out_.str();
  }

 private:
  void write(const char* name, Rgb c) { out_ << name << " " << c.r << " " << c.g << " " << c.b << "\n"; }
  void write(const char* name, Vec3f v) { out_ << name << " " << v.x << " " << v.y << " " << v.z << "\n"; }
  void write(const char* name, const Transform& transform) {
    out_ << name;
    for (const auto& row : transform.matrix()) {
      for (const double value : row) out_ << " " << static_cast<float>(value) + 0.0f;
    }
    out_ << "\n";
  }
  void write(const InstanceDescription& i) {
    write("instance", i.to_world);
    write(*i.mesh);
  }
  void write(const GltfDescription& d) {
    write("gltf base_color", d.base_color);
    write("specular_color", d.specular_color);
    write("sheen_color", d.sheen_color);
    out_ << d.metallic << " " << d.roughness << " " << d.ior << " " << d.specular << " " << d.transmission << " " << d.thin << " "
         << d.anisotropy << " " << d.anisotropy_rotation << " " << d.clearcoat << " " << d.clearcoat_roughness << " "
         << d.sheen_roughness << " " << d.vertex_colors << "\n";
  }
  void write(const CheckerboardDescription& t) {
    write("color0", t.color0);
    write("color1", t.color1);
    write("to_uv", t.to_uv);
  }
  void write(const BitmapDescription& t) {
    out_ << "bitmap " << static_cast<int>(t.filter) << " " << static_cast<int>(t.wrap) << "\n";
    write("to_uv", t.to_uv);
  }
  void write(const DiffuseDescription& m) {
    write("diffuse", m.reflectance);
    out_ << "texture " << m.reflectance_texture << "\n";
  }
  void write(const DielectricDescription& m) {
    out_ << "dielectric " << m.eta << "\n";
    write("reflects", m.specular_reflectance);
    write("transmits", m.specular_transmittance);
  }
  void write(const ConductorDescription& m) {
    out_ << "conductor " << m.perfect << "\n";
    write("eta", m.eta);
    write("k", m.k);
    write("reflects", m.specular_reflectance);
  }
  void write(const Roughness& r) {
    out_ << "rough " << static_cast<int>(r.distribution) << " " << r.alpha_u << " " << r.alpha_v << "\n";
  }
  void write(const RoughConductorDescription& m) {
    write(m.conductor);
    write(m.roughness);
  }
  void write(const RoughDielectricDescription& m) {
    write(m.dielectric);
    write(m.roughness);
  }
  void write(const PlasticDescription& m) {
    out_ << "plastic " << m.eta << " " << m.nonlinear << "\n";
    write("diffuse", m.diffuse_reflectance);
    write("reflects", m.specular_reflectance);
  }
  void write(const RoughPlasticDescription& m) {
    write(m.plastic);
    write(m.roughness);
  }
  void write(const PrincipledDescription& m) {
    write("principled", m.base_color);
    out_ << m.eta << " " << m.base_color_texture;
    for (const ScalarParameter& p : {m.roughness, m.anisotropic, m.metallic, m.spec_trans, m.spec_tint, m.sheen, m.sheen_tint,
                                     m.flatness, m.clearcoat, m.clearcoat_gloss}) {
      out_ << " " << p.factor << " " << p.texture;
    }
    out_ << "\n";
  }
  void write(const ThinDielectricDescription& m) { write(m.dielectric); }
  void write(const NullDescription&) { out_ << "null\n"; }
  void write(const MaskDescription& m) {
    out_ << "mask " << m.material << " " << m.opacity.factor << " " << m.opacity.texture << " " << m.cutoff.value_or(-1) << "\n";
  }
  void write(const BlendDescription& m) {
    out_ << "blend " << m.first << " " << m.second << " " << m.weight.factor << " " << m.weight.texture << "\n";
  }
  void write(const NormalMapDescription& m) {
    out_ << "normals " << m.material << " " << m.normals_texture << " " << m.scale << "\n";
  }
  void write(const BumpMapDescription& m) { out_ << "bumps " << m.material << " " << m.height_texture << " " << m.scale << "\n"; }
  void write(const MeshAttributeDescription& t) { out_ << "vertex_color " << t.scale << "\n"; }
  void write(const HomogeneousMediumDescription& m) {
    write("sigma_t", m.sigma_t);
    write("albedo", m.albedo);
    out_ << "g " << m.asymmetry << "\n";
  }
  void write(const TwosidedDescription& m) { out_ << "twosided " << m.front << " " << m.back << "\n"; }
  void write(const MeshDescription& mesh) {
    for (const Vec3f p : mesh.positions) write("v", p);
    for (const Vec3f n : mesh.normals) write("n", n);
    for (const Vec2f uv : mesh.uvs) out_ << "uv " << uv.x << " " << uv.y << "\n";
    for (const Rgb c : mesh.colors) write("c", c);
    for (const std::uint32_t i : mesh.indices) out_ << i << " ";
    out_ << "\n";
  }
  void write(const RectangleDescription& r) { write("rectangle", r.to_world); }
  void write(const DiskDescription& d) { write("disk", d.to_world); }
  void write(const SphereDescription& s) {
    write("sphere", s.center);
    out_ << s.radius << "\n";
  }
  void write(const PointEmitterDescription& e) {
    write("point", e.position);
    write("intensity", e.intensity);
  }
  void write(const SpotEmitterDescription& e) {
    write("spot", e.position);
    write("axis", e.axis);
    write("intensity", e.intensity);
    out_ << "cone " << e.cutoff_angle_degrees << " " << e.beam_width_degrees << "\n";
  }
  void write(const DirectionalEmitterDescription& e) {
    write("directional", e.direction);
    write("irradiance", e.irradiance);
  }
  void write(const ConstantEmitterDescription& e) { write("constant", e.radiance); }
  void write(const EnvmapEmitterDescription& e) {
    out_ << "envmap " << e.image.width << " " << e.image.height << "\n";
    for (const Rgb pixel : e.image.pixels) write("pixel", pixel);
    write("turned", e.to_world);
  }

  std::ostringstream out_;
};

inline std::string describe(const SceneDescription& scene) { return Describer().describe(scene); }

}  // namespace fluxfarm
