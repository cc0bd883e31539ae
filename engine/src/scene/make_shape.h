// From the description of a shape to the Shape that carries it out, and into the ray accelerator.
#pragma once

#include <memory>
#include <unordered_map>

#include "accel/ray_accelerator.h"
#include "geometry/shape.h"
#include "scene/description.h"

namespace fluxfarm {

// The meshes that instances share, each made when the first instance of it is.
class SharedMeshes {
 public:
  struct Entry {
    std::unique_ptr<TriangleMesh> mesh;
    Bounds bounds;
  };
  const Entry& of(const std::shared_ptr<const MeshDescription>& description, bool flipped);

 private:
  std::unordered_map<const MeshDescription*, Entry> meshes_[2];  // as they are, and with front and back swapped
};

// Makes the shape and adds it to `accelerator`. `emissive`: it will be sampled as a light. `shared` must outlive the shape.
std::unique_ptr<Shape> add_shape(const ShapeDescription& description, bool emissive, SharedMeshes& shared,
                                 RayAccelerator& accelerator);

}  // namespace fluxfarm
