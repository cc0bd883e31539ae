#include "io/gltf_accessor.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <limits>
#include <type_traits>

#include "io/limits.h"
#include "support/error.h"

namespace fluxfarm {
namespace {

static_assert(std::endian::native == std::endian::little, "glTF buffers are little-endian and are read as they lie");

constexpr std::uint64_t kMaxStride = 252;

// Calls `use` with a value of the C++ type of a glTF component type. Throws SceneError for an unknown one.
template <typename Use>
auto with_component(const GltfObject& object, const Use& use) {
  switch (object.required_count("componentType", 65535)) {
    case 5120: return use(std::int8_t{});
    case 5121: return use(std::uint8_t{});
    case 5122: return use(std::int16_t{});
    case 5123: return use(std::uint16_t{});
    case 5125: return use(std::uint32_t{});
    case 5126: return use(float{});
    default: object.fail("componentType", "expected 5120, 5121, 5122, 5123, 5125 or 5126");
  }
}

void check_type(const GltfObject& accessor, std::size_t components) {
  static constexpr const char* kTypes[] = {"SCALAR", "VEC2", "VEC3", "VEC4"};
  const char* expected = kTypes[components - 1];
  if (accessor.text("type", "") != expected) accessor.fail("type", std::string("expected \"") + expected + "\"");
}

// The value of a component as an accessor means it.
template <typename Target, typename Component>
Target converted(Component value, bool normalized) {
  if constexpr (std::is_floating_point_v<Target> && std::is_integral_v<Component>) {
    if (normalized)
      return std::max(static_cast<Target>(value) / static_cast<Target>(std::numeric_limits<Component>::max()), Target{-1});
  }
  return static_cast<Target>(value);
}

// `count` elements of `components` components from `offset` on, `stride` bytes apart; `place` has the accessor or its part.
template <typename Component, typename Target>
void copy_elements(std::string_view bytes, std::uint64_t offset, std::uint64_t stride, std::uint64_t count, std::size_t components,
                   bool normalized, Target* out) {
  for (std::uint64_t i = 0; i < count; ++i) {
    const char* element = bytes.data() + offset + i * stride;
    for (std::size_t c = 0; c < components; ++c) {
      Component value;
      std::memcpy(&value, element + c * sizeof(Component), sizeof(Component));
      *out++ = converted<Target>(value, normalized);
    }
  }
}

// Reads what `object` says of a buffer view (bufferView, byteOffset, componentType) into `out`.
template <typename Target>
void read_view(GltfFile& file, const GltfObject& object, std::uint64_t count, std::size_t components, bool normalized, bool strided,
               Target* out) {
  const std::size_t index = object.required_index("bufferView", "bufferViews", file.size("bufferViews"));
  const std::string_view bytes = file.buffer_view(index);
  const std::uint64_t offset = object.count("byteOffset", kMaxMeshFileBytes).value_or(0);
  with_component(object, [&](auto component) {
    using Component = decltype(component);
    if (std::is_integral_v<Target> && !std::is_unsigned_v<Component>)
      object.fail("componentType", "expected 5121, 5123 or 5125, unsigned integers");
    const std::uint64_t size = components * sizeof(Component);
    const GltfObject view = file.at("bufferViews", index);
    const std::uint64_t stride = strided ? view.count("byteStride", kMaxStride).value_or(size) : size;
    if (stride < size) view.fail("byteStride", "expected at least " + std::to_string(size) + ", the size of an element");
    // No overflow: each factor is bounded.
    if (count > 0 && offset + (count - 1) * stride + size > bytes.size()) {
      object.fail("bufferView", "which has " + std::to_string(bytes.size()) + " bytes, too few for " + std::to_string(count) +
                                    " elements of " + std::to_string(size) + " bytes, " + std::to_string(stride) +
                                    " apart, from byte " + std::to_string(offset) + " on");
    }
    copy_elements<Component>(bytes, offset, stride, count, components, normalized, out);
  });
}

// Values that replace some elements.
template <typename Target>
void apply_sparse(GltfFile& file, const GltfObject& accessor, std::size_t components, bool normalized,
                  std::vector<Target>& elements) {
  const std::optional<GltfObject> sparse = accessor.object("sparse");
  if (!sparse) return;
  const std::uint64_t count = sparse->required_count("count", elements.size() / components);
  const GltfObject where = sparse->required_object("indices"), what = sparse->required_object("values");
  // The values have the component type of the accessor; an object of their own lacks it.
  std::vector<std::uint32_t> indices(count);
  read_view(file, where, count, 1, false, false, indices.data());
  JsonValue described = what.json();
  std::get<JsonValue::Object>(described.value).push_back({"componentType", *accessor.json().member("componentType")});
  std::vector<Target> values(count * components);
  read_view(file, GltfObject(described, what.place()), count, components, normalized, false, values.data());
  for (std::uint64_t i = 0; i < count; ++i) {
    if (indices[i] >= elements.size() / components) {
      throw SceneError(where.place(), "element " + std::to_string(i) + " is " + std::to_string(indices[i]) +
                                          ", expected an index below " + std::to_string(elements.size() / components));
    }
    std::copy_n(&values[i * components], components, &elements[indices[i] * components]);
  }
}

template <typename Target>
std::vector<Target> read(GltfFile& file, std::size_t index, std::size_t components) {
  const GltfObject accessor = file.at("accessors", index);
  check_type(accessor, components);
  const std::uint64_t count = accessor_count(file, index);
  const bool normalized = accessor.boolean("normalized", false);
  std::vector<Target> elements;
  if (accessor.has("bufferView")) {
    // Memory is taken only for what the buffer can hold: at least a byte a component.
    const std::size_t view = accessor.required_index("bufferView", "bufferViews", file.size("bufferViews"));
    if (count * components > file.buffer_view(view).size())
      accessor.fail("count", "but its buffer view has only " + std::to_string(file.buffer_view(view).size()) + " bytes");
    elements.resize(count * components);
    read_view(file, accessor, count, components, normalized, true, elements.data());
  } else {
    if (count > kMaxZeroElements)
      accessor.fail("count", "expected at most " + std::to_string(kMaxZeroElements) + " without a bufferView");
    with_component(accessor, [](auto) {});
    elements.resize(count * components);
  }
  apply_sparse(file, accessor, components, normalized, elements);
  return elements;
}

}  // namespace

std::uint64_t accessor_count(const GltfFile& file, std::size_t accessor) {
  return file.at("accessors", accessor).required_count("count", kMaxAccessorElements);
}

std::vector<float> read_floats(GltfFile& file, std::size_t accessor, std::size_t components) {
  return read<float>(file, accessor, components);
}

std::vector<std::uint32_t> read_indices(GltfFile& file, std::size_t accessor) { return read<std::uint32_t>(file, accessor, 1); }

}  // namespace fluxfarm
