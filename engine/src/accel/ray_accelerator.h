// Finds where rays meet shapes. The only room that knows Embree.
//
// Embree 3.13 and 4.x both serve. The header's and the library's version are compared at start: a mismatch reads hits from the
// wrong place without any error (seen with 4.2 headers and a 4.4 library).
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "geometry/disk.h"
#include "geometry/mesh_instance.h"
#include "geometry/rectangle.h"
#include "geometry/sphere.h"
#include "geometry/surface_point.h"
#include "geometry/triangle_mesh.h"
#include "math/ray.h"

namespace fluxfarm {

// Version of the loaded library and the instruction set that it chooses on this machine: its hits may differ in the last bits
// from one set to another.
std::string ray_library_version();

// Switches the calling thread to flush denormals to zero, as Embree asks of every thread that traces rays.
void prepare_render_thread();

// A ray that a benchmark wants to trace again.
struct RecordedRay {
  Ray ray;
  bool occlusion = false;
};

class RayAccelerator {
 public:
  // `threads`: how many build the tree; 0 takes all.
  explicit RayAccelerator(int threads);
  ~RayAccelerator();
  RayAccelerator(const RayAccelerator&) = delete;
  RayAccelerator& operator=(const RayAccelerator&) = delete;

  // Adds a shape, which must outlive this; Hit::shape counts shapes in the order of these calls.
  void add(const TriangleMesh& mesh);
  void add(const Rectangle& rectangle);
  void add(const Disk& disk);
  void add(const Sphere& sphere);
  // Instances of the same mesh share its tree.
  void add(const MeshInstance& instance);
  // Call once, after the last add. Throws ResourceError when memory runs out.
  void build();

  // For each ray the nearest hit in (t_min, t_max); Hit::shape is Hit::kNone where there is none. Rays are traced in packets of
  // sixteen in the order given: the last bits of a hit may depend on which rays share its packet, so callers that promise the same
  // bits must group rays the same way each time.
  // `coherent` promises that they start and point alike, which is traced faster; it is no condition for a right result.
  void intersect(std::span<const Ray> rays, std::span<Hit> hits, bool coherent) const;
  // For each ray whether anything lies in (t_min, t_max).
  void occluded(std::span<const Ray> rays, std::span<bool> occluded, bool coherent) const;

  // One ray. Nearest hit in (t_min, t_max); false if there is none.
  bool intersect(const Ray& ray, Hit& hit) const;
  // Whether anything lies in (t_min, t_max).
  bool occluded(const Ray& ray) const;
  // Traces the rays one by one with nothing around it, and returns how many hit: what Embree alone can do, for benchmarks.
  std::uint64_t replay(std::span<const RecordedRay> rays) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace fluxfarm
