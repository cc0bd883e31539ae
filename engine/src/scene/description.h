// Plain description of a scene, as the readers in io/ fill it in and CompiledScene takes it. No behaviour, no rays.
//
// Units: metres, radiance W m^-2 sr^-1, intensity W sr^-1, linear Rec.709 RGB; right-handed, y up.
// Every value was checked by the reader: finite, in range, references resolved to indices.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "emitters/lat_long_image.h"
#include "materials/material_description.h"
#include "math/frame.h"
#include "math/rgb.h"
#include "math/transform.h"
#include "math/vec.h"
#include "media/medium_description.h"
#include "sampling/pixel_filter.h"
#include "textures/texture_description.h"

namespace fluxfarm {

// ---------------------------------------------------------------- shapes

// Triangle mesh in world space. Normals, texture coordinates and colours are per vertex or absent (empty).
struct MeshDescription {
  std::vector<Vec3f> positions;
  std::vector<Vec3f> normals;  // unit length
  std::vector<Vec2f> uvs;
  std::vector<std::uint32_t> indices;  // three per triangle; counter-clockwise seen from the front
  std::vector<Rgb> colors{};           // linear Rec.709, in [0, 1]
};

// A mesh in its own space, placed in the world. Descriptions that point to the same mesh share it: it is kept once, however often
// it is placed. The front stays on its side, also under a mirroring transform. Never emissive.
struct InstanceDescription {
  std::shared_ptr<const MeshDescription> mesh;
  Transform to_world;  // invertible
};

// Image of the square [-1,1]^2 x {0} with normal +z under an affine map.
struct RectangleDescription {
  Transform to_world;
};

// Image of the unit disk in the xy plane with normal +z; to_world must keep it a circle.
struct DiskDescription {
  Transform to_world;
};

// Normals point outwards, or inwards with ShapeDescription::flip_normals.
struct SphereDescription {
  Vec3f center;
  float radius = 1;
  Frame axes{};  // the sphere's own axes in the world, unit; left-handed when mirrored
};

struct ShapeDescription {
  std::string name;  // id of the shape in the scene file, or its place there; for messages
  std::variant<MeshDescription, RectangleDescription, DiskDescription, SphereDescription, InstanceDescription> geometry;
  bool flip_normals = false;            // swaps front and back; the compiled scene applies it, the reader does not
  int material = 0;                     // index into SceneDescription::materials
  std::optional<Rgb> emitted_radiance;  // area emitter on the front side
  bool emits_on_both_sides = false;     // then on the back side, too
  // Indices into SceneDescription::media. With either, a ray that leaves the surface goes into the one on its side; with none, it
  // stays in the medium in which it came.
  int interior_medium = kNoMedium;  // behind the front side
  int exterior_medium = kNoMedium;  // before the front side
};

// ---------------------------------------------------------------- emitters without a shape

struct PointEmitterDescription {
  Vec3f position;
  Rgb intensity{1.0f};  // W sr^-1
};

// A point that shines into a cone: the full intensity within beam_width of the axis, none beyond the cut-off, linear in the angle
// between them.
struct SpotEmitterDescription {
  Vec3f position;
  Vec3f axis{0, 0, 1};  // world, unit
  Rgb intensity{1.0f};  // W sr^-1
  float cutoff_angle_degrees = 20;
  float beam_width_degrees = 15;  // half angle, like the cut-off
};

// Parallel light from infinitely far away.
struct DirectionalEmitterDescription {
  Vec3f direction{0, 0, 1};  // world, unit, in which the light travels
  Rgb irradiance{1.0f};      // W m^-2 on a surface across it
};

// The same radiance from every direction, from infinitely far away.
struct ConstantEmitterDescription {
  Rgb radiance{1.0f};
};

// Radiance from infinitely far away, as the image tells it. A scene has one at most.
struct EnvmapEmitterDescription {
  LatLongImage image;
  Transform to_world;  // turns, or mirrors, the image's directions
};

using EmitterDescription = std::variant<PointEmitterDescription, SpotEmitterDescription, DirectionalEmitterDescription,
                                        ConstantEmitterDescription, EnvmapEmitterDescription>;

// ---------------------------------------------------------------- camera, film, method

struct FilmDescription {
  int width = 768;
  int height = 576;
  // Part of the frame to render, in pixels; crop_width 0 means the full frame.
  int crop_x = 0, crop_y = 0, crop_width = 0, crop_height = 0;
  PixelFilterDescription filter;
};

// Perspective, through a pinhole or a thin lens. Camera space: looks along +z, +y up, +x left.
struct CameraDescription {
  Transform to_world;
  enum class FovAxis { kX, kY, kDiagonal, kSmaller, kLarger };
  FovAxis fov_axis = FovAxis::kX;
  float fov_degrees = 45;  // full angle along fov_axis
  float near_clip = 1e-2f;
  float far_clip = 1e4f;
  float aperture_radius = 0;  // m; 0 is a pinhole
  float focus_distance = 1;   // m along the view axis, to the plane that a lens shows sharply
  int medium = kNoMedium;     // in which the camera stands: index into SceneDescription::media
  float unit = 1;             // m, of the lengths above and of all places: 1 but in a working frame (scene/working_frame.h)
};

struct MethodDescription {
  std::string integrator = "path";
  int max_depth = -1;  // path edges: 1 shows emitters only, 2 adds direct light; -1 is unlimited
  int rr_depth = 5;    // first bounce at which Russian roulette may end a path
  bool hide_emitters = false;
  // Of methods with photon maps: photons shot for each sample of the pixels, by "photon" for each of its two kinds of maps; 0 is a
  // default.
  std::uint64_t photons = 0;
  bool final_gather = true;  // of "photon": a ray gathers indirect light; else it is read from the map directly
  float first_radius = 2;    // of "photon-progressive": of density estimates after the first sample, over the side of a pixel
};

struct SceneDescription {
  std::vector<MaterialDescription> materials;
  std::vector<TextureDescription> textures;
  std::vector<HomogeneousMediumDescription> media;
  std::vector<ShapeDescription> shapes;
  std::vector<EmitterDescription> emitters;
  CameraDescription camera;
  FilmDescription film;
  MethodDescription method;
  int samples_per_pixel = 0;  // 0: the file does not say
  std::vector<std::string> warnings;
};

}  // namespace fluxfarm
