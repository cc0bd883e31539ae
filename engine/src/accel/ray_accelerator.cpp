#include "accel/ray_accelerator.h"

#include <algorithm>
#include <array>
#include <limits>
#include <unordered_map>
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
  // Trees of the meshes that instances place.
  std::unordered_map<const TriangleMesh*, RTCScene> shared;
  std::uint32_t shapes = 0;

  void attach(RTCGeometry geometry) {
    rtcCommitGeometry(geometry);
    rtcAttachGeometryByID(scene, geometry, shapes++);
    rtcReleaseGeometry(geometry);
  }

  RTCGeometry make_triangles(const Vec3f* positions, std::size_t vertices, const std::uint32_t* indices,
                             std::size_t triangles) const {
    RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, positions, 0, sizeof(Vec3f), vertices);
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, indices, 0, 3 * sizeof(std::uint32_t),
                               triangles);
    return geometry;
  }
  RTCGeometry make_triangles(const TriangleMesh& mesh) const {
    const TriangleMesh::Data& data = mesh.data();
    return make_triangles(data.positions.data(), data.positions.size(), data.indices.data(), mesh.triangles());
  }

  // A scene of that mesh alone: its only geometry has the number 0.
  RTCScene tree_of(const TriangleMesh& mesh) {
    RTCScene& tree = shared[&mesh];
    if (tree != nullptr) return tree;
    tree = rtcNewScene(device);
    RTCGeometry geometry = make_triangles(mesh);
    rtcCommitGeometry(geometry);
    rtcAttachGeometryByID(tree, geometry, 0);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(tree);
    return tree;
  }

  // Number of the shape that Embree hit: an instance is known by its own number, not by that of the geometry inside it.
  static std::uint32_t shape_of(std::uint32_t geometry, std::uint32_t instance) {
    return instance != RTC_INVALID_GEOMETRY_ID ? instance : geometry;
  }

  void throw_on_error(const char* doing) const {
    const RTCError error = rtcGetDeviceError(device);
    if (error == RTC_ERROR_NONE) return;
    throw ResourceError(std::string("Embree failed while ") + doing + " (error " + std::to_string(error) +
                        (error == RTC_ERROR_OUT_OF_MEMORY ? ", out of memory)" : ")"));
  }
};

namespace {

// The set that Embree picks when it starts: the widest that it was built for and that the processor has.
std::string chosen_instruction_set() {
#if defined(__x86_64__)
  __builtin_cpu_init();
  const bool avx512 = __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
                      __builtin_cpu_supports("avx512cd") && __builtin_cpu_supports("avx512bw") &&
                      __builtin_cpu_supports("avx512vl");
  if (avx512) return "AVX-512";
  if (__builtin_cpu_supports("avx2")) return "AVX2";
  if (__builtin_cpu_supports("avx")) return "AVX";
  return "SSE";
#else
  return "baseline";
#endif
}

}  // namespace

std::string ray_library_version() {
  RTCDevice device = rtcNewDevice("threads=1,set_affinity=0");
  const auto version = rtcGetDeviceProperty(device, RTC_DEVICE_PROPERTY_VERSION);
  rtcReleaseDevice(device);
  const auto number =
      std::to_string(version / 10000) + "." + std::to_string(version / 100 % 100) + "." + std::to_string(version % 100);
  return number + " " + chosen_instruction_set();
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
  if (impl_->device == nullptr)
    throw ResourceError("Embree cannot make a device (error " + std::to_string(rtcGetDeviceError(nullptr)) + ")");
  const auto loaded = rtcGetDeviceProperty(impl_->device, RTC_DEVICE_PROPERTY_VERSION);
  if (loaded != RTC_VERSION) {
    throw ResourceError("Embree library " + std::to_string(loaded) + " was loaded, but the engine was built with headers of " +
                        std::to_string(RTC_VERSION));
  }
  impl_->scene = rtcNewScene(impl_->device);
}

RayAccelerator::~RayAccelerator() {
  for (const auto& [mesh, tree] : impl_->shared) rtcReleaseScene(tree);
  if (impl_->scene != nullptr) rtcReleaseScene(impl_->scene);
  if (impl_->device != nullptr) rtcReleaseDevice(impl_->device);
}

void RayAccelerator::add(const TriangleMesh& mesh) { impl_->attach(impl_->make_triangles(mesh)); }

void RayAccelerator::add(const MeshInstance& instance) {
  RTCGeometry geometry = rtcNewGeometry(impl_->device, RTC_GEOMETRY_TYPE_INSTANCE);
  rtcSetGeometryInstancedScene(geometry, impl_->tree_of(instance.mesh()));
  const Transform::Matrix& m = instance.to_world().matrix();
  std::array<float, 12> columns;
  for (std::size_t i = 0; i < columns.size(); ++i) columns[i] = static_cast<float>(m[i % 3][i / 3]);
  rtcSetGeometryTransform(geometry, 0, RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR, columns.data());
  impl_->attach(geometry);
}

void RayAccelerator::add(const Rectangle& rectangle) {
  static constexpr std::uint32_t kIndices[6] = {0, 1, 2, 0, 2, 3};
  auto corners = std::make_unique<std::array<Vec3f, 5>>();
  for (int i = 0; i < 4; ++i) (*corners)[i] = rectangle.corner(i);
  impl_->attach(impl_->make_triangles(corners->data(), 4, kIndices, 2));
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
  query.ray = {ray.origin.x,
               ray.origin.y,
               ray.origin.z,
               ray.t_min,
               ray.direction.x,
               ray.direction.y,
               ray.direction.z,
               0,
               ray.t_max,
               0xffffffffu,
               0,
               0};
  query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  embree_intersect(impl_->scene, query);
  if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return false;
  hit = {query.ray.tfar, Impl::shape_of(query.hit.geomID, query.hit.instID[0]), query.hit.primID, query.hit.u, query.hit.v};
  return true;
}

bool RayAccelerator::occluded(const Ray& ray) const {
  RTCRay query = {ray.origin.x,
                  ray.origin.y,
                  ray.origin.z,
                  ray.t_min,
                  ray.direction.x,
                  ray.direction.y,
                  ray.direction.z,
                  0,
                  ray.t_max,
                  0xffffffffu,
                  0,
                  0};
  embree_occluded(impl_->scene, query);
  return query.tfar < 0;
}

namespace {

constexpr std::size_t kPacket = 16;
// Fewer rays than this are traced one by one: an almost empty packet costs more.
constexpr std::size_t kMinPacket = 4;

// Fills lanes 0 .. rays.size() - 1 and marks them in `valid`. The others get an empty interval, too: on machines without 16-wide
// vectors Embree traces the packet as a stream, which does not look at `valid`.
template <typename Packet>
void fill(std::span<const Ray> rays, int* valid, Packet& packet) {
  for (std::size_t i = 0; i < kPacket; ++i) {
    const bool used = i < rays.size();
    valid[i] = used ? -1 : 0;
    const Ray& ray = rays[used ? i : 0];
    packet.org_x[i] = ray.origin.x;
    packet.org_y[i] = ray.origin.y;
    packet.org_z[i] = ray.origin.z;
    packet.dir_x[i] = ray.direction.x;
    packet.dir_y[i] = ray.direction.y;
    packet.dir_z[i] = ray.direction.z;
    packet.tnear[i] = ray.t_min;
    packet.tfar[i] = used ? ray.t_max : -std::numeric_limits<float>::infinity();
    packet.time[i] = 0;
    packet.mask[i] = 0xffffffffu;
    packet.id[i] = 0;
    packet.flags[i] = 0;
  }
}

}  // namespace

void RayAccelerator::intersect(std::span<const Ray> rays, std::span<Hit> hits, bool coherent) const {
  while (rays.size() >= kMinPacket) {
    const std::size_t count = std::min(rays.size(), kPacket);
    alignas(64) int valid[kPacket];
    RTCRayHit16 packet;
    fill(rays.first(count), valid, packet.ray);
    for (std::size_t i = 0; i < kPacket; ++i) packet.hit.geomID[i] = packet.hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
    embree_intersect(impl_->scene, valid, coherent, packet);
    for (std::size_t i = 0; i < count; ++i) {
      hits[i] = {packet.ray.tfar[i], packet.hit.geomID[i], packet.hit.primID[i], packet.hit.u[i], packet.hit.v[i]};
    }
    if (!impl_->shared.empty()) {
      for (std::size_t i = 0; i < count; ++i) hits[i].shape = Impl::shape_of(packet.hit.geomID[i], packet.hit.instID[0][i]);
    }
    rays = rays.subspan(count);
    hits = hits.subspan(count);
  }
  for (std::size_t i = 0; i < rays.size(); ++i) {
    if (!intersect(rays[i], hits[i])) hits[i].shape = Hit::kNone;
  }
}

void RayAccelerator::occluded(std::span<const Ray> rays, std::span<bool> occluded_out, bool coherent) const {
  while (rays.size() >= kMinPacket) {
    const std::size_t count = std::min(rays.size(), kPacket);
    alignas(64) int valid[kPacket];
    RTCRay16 packet;
    fill(rays.first(count), valid, packet);
    embree_occluded(impl_->scene, valid, coherent, packet);
    for (std::size_t i = 0; i < count; ++i) occluded_out[i] = packet.tfar[i] < 0;
    rays = rays.subspan(count);
    occluded_out = occluded_out.subspan(count);
  }
  for (std::size_t i = 0; i < rays.size(); ++i) occluded_out[i] = occluded(rays[i]);
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
