#include "accel/ray_accelerator.h"

#include <array>
#include <vector>

#if defined(__SSE2__)
#include <pmmintrin.h>
#include <xmmintrin.h>
#endif

#include "accel/embree.h"
#include "accel/quadric_geometry.h"
#include "support/error.h"

namespace fluxfarm {

struct RayAccelerator::Impl {
  RTCDevice device = nullptr;
  RTCScene scene = nullptr;
  // Vertices of rectangles, which have no mesh of their own; padded to the 16 bytes that Embree reads.
  std::vector<std::unique_ptr<std::array<Vec3f, 5>>> corners;
  std::uint32_t shapes = 0;

  void attach(RTCGeometry geometry) {
    rtcCommitGeometry(geometry);
    rtcAttachGeometryByID(scene, geometry, shapes++);
    rtcReleaseGeometry(geometry);
  }

  void attach_triangles(const Vec3f* positions, std::size_t vertices, const std::uint32_t* indices, std::size_t triangles) {
    RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, positions, 0, sizeof(Vec3f), vertices);
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, indices, 0, 3 * sizeof(std::uint32_t),
                               triangles);
    attach(geometry);
  }

  void throw_on_error(const char* doing) const {
    const RTCError error = rtcGetDeviceError(device);
    if (error == RTC_ERROR_NONE) return;
    throw ResourceError(std::string("Embree failed while ") + doing + " (error " + std::to_string(error) +
                        (error == RTC_ERROR_OUT_OF_MEMORY ? ", out of memory)" : ")"));
  }
};

std::string ray_library_version() {
  RTCDevice device = rtcNewDevice("threads=1,set_affinity=0");
  const auto version = rtcGetDeviceProperty(device, RTC_DEVICE_PROPERTY_VERSION);
  rtcReleaseDevice(device);
  return std::to_string(version / 10000) + "." + std::to_string(version / 100 % 100) + "." + std::to_string(version % 100);
}

void prepare_render_thread() {
#if defined(__SSE2__)
  _MM_SET_FLUSH_ZERO_MODE(_MM_FLUSH_ZERO_ON);
  _MM_SET_DENORMALS_ZERO_MODE(_MM_DENORMALS_ZERO_ON);
#endif
}

RayAccelerator::RayAccelerator(int threads) : impl_(std::make_unique<Impl>()) {
  const std::string config = "threads=" + std::to_string(threads);
  impl_->device = rtcNewDevice(config.c_str());
  if (impl_->device == nullptr) throw ResourceError("Embree cannot make a device (error " + std::to_string(rtcGetDeviceError(nullptr)) + ")");
  const auto loaded = rtcGetDeviceProperty(impl_->device, RTC_DEVICE_PROPERTY_VERSION);
  if (loaded != RTC_VERSION) {
    throw ResourceError("Embree library " + std::to_string(loaded) + " was loaded, but the engine was built with headers of " +
                        std::to_string(RTC_VERSION));
  }
  impl_->scene = rtcNewScene(impl_->device);
}

RayAccelerator::~RayAccelerator() {
  if (impl_->scene != nullptr) rtcReleaseScene(impl_->scene);
  if (impl_->device != nullptr) rtcReleaseDevice(impl_->device);
}

void RayAccelerator::add(const TriangleMesh& mesh) {
  const TriangleMesh::Data& data = mesh.data();
  impl_->attach_triangles(data.positions.data(), data.positions.size(), data.indices.data(), mesh.triangles());
}

void RayAccelerator::add(const Rectangle& rectangle) {
  static constexpr std::uint32_t kIndices[6] = {0, 1, 2, 0, 2, 3};
  auto corners = std::make_unique<std::array<Vec3f, 5>>();
  for (int i = 0; i < 4; ++i) (*corners)[i] = rectangle.corner(i);
  impl_->attach_triangles(corners->data(), 4, kIndices, 2);
  impl_->corners.push_back(std::move(corners));
}

void RayAccelerator::add(const Disk& disk) { impl_->attach(make_disk_geometry(impl_->device, disk)); }

void RayAccelerator::add(const Sphere& sphere) { impl_->attach(make_sphere_geometry(impl_->device, sphere)); }

void RayAccelerator::build() {
  rtcCommitScene(impl_->scene);
  impl_->throw_on_error("building the ray acceleration structure");
}

bool RayAccelerator::intersect(const Ray& ray, Hit& hit) const {
  RTCRayHit query;
  query.ray = {ray.origin.x, ray.origin.y, ray.origin.z, ray.t_min, ray.direction.x, ray.direction.y, ray.direction.z,
               0,            ray.t_max,    0xffffffffu,  0,         0};
  query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  embree_intersect(impl_->scene, query);
  if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return false;
  hit = {query.ray.tfar, query.hit.geomID, query.hit.primID, query.hit.u, query.hit.v};
  return true;
}

bool RayAccelerator::occluded(const Ray& ray) const {
  RTCRay query = {ray.origin.x, ray.origin.y, ray.origin.z, ray.t_min, ray.direction.x, ray.direction.y, ray.direction.z,
                  0,            ray.t_max,    0xffffffffu,  0,         0};
  embree_occluded(impl_->scene, query);
  return query.tfar < 0;
}

std::uint64_t RayAccelerator::replay(std::span<const RecordedRay> rays) const {
  std::uint64_t hits = 0;
  Hit hit;
  for (const RecordedRay& recorded : rays) {
    hits += recorded.occlusion ? occluded(recorded.ray) : intersect(recorded.ray, hit);
  }
  return hits;
}

}  // namespace fluxfarm
