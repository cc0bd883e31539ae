// The compiled scene: immutable, shared by all threads, everything an integrator asks of it.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "accel/ray_accelerator.h"
#include "emitters/emitter.h"
#include "emitters/emitter_choice.h"
#include "emitters/envmap_emitter.h"
#include "materials/bsdf.h"
#include "materials/textured_material.h"
#include "media/homogeneous_medium.h"
#include "scene/camera.h"
#include "scene/description.h"
#include "scene/make_shape.h"
#include "textures/make_texture.h"

namespace fluxfarm {

// What the scene contains, counted at load: the facts by which parts of the engine are built or left out.
struct Census {
  std::size_t shapes = 0;
  std::size_t triangles = 0;  // of meshes, each counted once however often it is placed
  std::size_t instances = 0;  // placed meshes that share their triangles
  std::size_t area_emitters = 0, point_emitters = 0, spot_emitters = 0, directional_emitters = 0;
  bool environment = false;      // a constant one
  bool environment_map = false;  // an image
  std::size_t materials = 0, textures = 0;
  bool delta_materials = false;        // some material has only delta lobes
  bool delta_lobes = false;            // or has one among others: mirrors and glass are seen, caustics fall
  bool anisotropic_materials = false;  // tangent frames are needed
  bool normal_maps = false;            // or bump maps
  bool vertex_colors = false;          // a texture shows them
  bool masks = false;                  // some material lets light straight through a part of the surface, or all of it
  bool shading_normals = false;        // some mesh has normals of its own
  std::size_t media = 0;
  bool coloured_media = false;   // the extinction of some medium differs between the channels
  bool null_boundaries = false;  // light passes some surface as if it was not there
};

class WorkingDescription;

class Scene {
 public:
  // One surface of the scene with all that belongs to it.
  struct Surface {
    std::unique_ptr<Shape> shape;
    // Asked for light that arrives on the front and on the back; the same one unless the material is two-sided.
    const Bsdf* front = nullptr;
    const Bsdf* back = nullptr;
    const AreaEmitter* emitter = nullptr;  // nullptr: does not emit
    std::uint32_t emitter_index = 0;       // of it in emitters()
    bool two_sided = false;
    bool transmits = false;    // light can pass to the other side
    bool anisotropic = false;  // or has a normal map: the frame follows the texture coordinates
    bool textured = false;     // on one side at least: ask textured_material()
    // What a textured material needs to know of a place besides uv.
    bool bumpy = false, vertex_colored = false;
    // The material's answers to the questions of the same name.
    bool has_continuous_lobe = false, chooses_lobe = false;
    bool glossy = false;  // scatters some light less evenly than a diffuse surface: into single directions, or around them
  };

  // Compiles a description whose film has the final size. `threads` build the ray accelerator; 0 takes all.
  // Throws SceneError or ResourceError.
  Scene(const SceneDescription& description, int threads);

  const Surface& surface(std::uint32_t shape) const { return surfaces_[shape]; }
  // What gives the Bsdf of one side of a textured surface at a hit; null where that side has no texture.
  const TexturedMaterial* textured_material(std::uint32_t shape, bool back) const {
    const TexturedSides& sides = textured_sides_[shape];
    return back ? sides.back : sides.front;
  }
  // What lies on the two sides of a surface, in a scene with media or null boundaries.
  struct Boundary {
    const HomogeneousMedium* interior = nullptr;  // behind the front side; nullptr: vacuum
    const HomogeneousMedium* exterior = nullptr;  // before it
    bool separates = false;                       // false: no media of its own, a ray stays in the one in which it came
    bool invisible = false;                       // a null boundary

    // The medium of a ray that leaves `point` of this surface, having come in `current`.
    const HomogeneousMedium* towards(Vec3f direction, const SurfacePoint& point, const HomogeneousMedium* current) const {
      if (!separates) return current;
      return dot(direction, point.geometric_normal) > 0 ? exterior : interior;
    }
  };
  const Boundary& boundary(std::uint32_t shape) const { return boundaries_[shape]; }
  const std::vector<HomogeneousMedium>& media() const { return media_; }
  const HomogeneousMedium* camera_medium() const { return camera_medium_; }  // nullptr: vacuum
  const RayAccelerator& accelerator() const { return *accelerator_; }
  const EmitterChoice& emitters() const { return emitter_choice_; }
  // Radiance of the constant environment; empty without one.
  const std::optional<Rgb>& environment() const { return environment_; }
  struct EnvironmentMap {
    const EnvmapEmitter* emitter = nullptr;  // nullptr: none
    float choice_probability = 0;            // in next-event estimation, the same everywhere
  };
  // All that emit, in the order of emitters(); the constant environment is none of them.
  const std::vector<const Emitter*>& emitter_list() const { return emitter_list_; }
  // The middle of the box around all surfaces.
  Vec3f center() const { return center_; }
  // Of a sphere around center() that holds them, m.
  float radius() const { return radius_; }
  const EnvironmentMap& environment_map() const { return environment_map_; }
  const Camera& camera() const { return camera_; }
  const FilmDescription& film() const { return film_; }
  const PixelFilter& pixel_filter() const { return pixel_filter_; }
  const MethodDescription& method() const { return method_; }
  const Census& census() const { return census_; }
  const std::vector<std::string>& warnings() const { return warnings_; }

 private:
  Scene(const WorkingDescription& working, int threads);

  struct TexturedSides {
    const TexturedMaterial* front = nullptr;
    const TexturedMaterial* back = nullptr;
  };
  Boundary boundary_of(const ShapeDescription& shape, const MaterialDescription& material) const;
  const HomogeneousMedium* medium(int index) const;
  TexturedSides textured_sides(const std::vector<MaterialDescription>& materials, std::size_t material) const;

  FilmDescription film_;
  MethodDescription method_;
  PixelFilter pixel_filter_;
  Camera camera_;
  std::vector<std::unique_ptr<Bsdf>> bsdfs_;
  Textures textures_;
  std::vector<std::unique_ptr<TexturedMaterial>> textured_materials_;  // one for each material; null without texture
  std::vector<TexturedSides> textured_sides_;                          // one for each surface
  std::vector<HomogeneousMedium> media_;
  const HomogeneousMedium* camera_medium_ = nullptr;
  std::vector<Boundary> boundaries_;  // one for each surface; empty without media and null boundaries
  SharedMeshes shared_meshes_;
  std::vector<Surface> surfaces_;
  std::vector<std::unique_ptr<AreaEmitter>> area_emitters_;
  std::vector<std::unique_ptr<Emitter>> free_emitters_;  // those without a shape
  EmitterChoice emitter_choice_;
  std::optional<Rgb> environment_;
  EnvironmentMap environment_map_;
  std::vector<const Emitter*> emitter_list_;
  Vec3f center_;
  float radius_ = 0;
  std::unique_ptr<RayAccelerator> accelerator_;
  Census census_;
  std::vector<std::string> warnings_;
};

}  // namespace fluxfarm
