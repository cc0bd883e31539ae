#include "io/gltf_file.h"

#include <cstdint>
#include <set>

#include "io/data_uri.h"
#include "io/limits.h"
#include "io/text.h"
#include "support/error.h"

namespace fluxfarm {
namespace {

const std::set<std::string>& known_extensions() {
  static const std::set<std::string> known = {"EXT_mesh_gpu_instancing",
                                              "KHR_lights_punctual",
                                              "KHR_materials_anisotropy",
                                              "KHR_materials_clearcoat",
                                              "KHR_materials_emissive_strength",
                                              "KHR_materials_ior",
                                              "KHR_materials_sheen",
                                              "KHR_materials_specular",
                                              "KHR_materials_transmission",
                                              "KHR_materials_unlit",
                                              "KHR_materials_volume",
                                              "KHR_mesh_quantization",
                                              "KHR_texture_transform"};
  return known;
}

constexpr std::size_t kHeaderBytes = 12, kChunkHeaderBytes = 8;
constexpr std::uint32_t kJsonChunk = 0x4E4F534A, kBinaryChunk = 0x004E4942;

std::uint32_t integer_at(std::string_view bytes, std::size_t offset) {
  std::uint32_t result = 0;
  for (std::size_t i = 0; i < 4; ++i) result |= std::uint32_t{static_cast<unsigned char>(bytes[offset + i])} << (8 * i);
  return result;
}

// The texts of an array of them.
std::vector<std::string> texts(const GltfObject& root, const char* name) {
  const JsonValue* value = root.json().member(name);
  if (!value) return {};
  if (!value->array()) root.fail(name, "expected an array of texts");
  std::vector<std::string> result;
  for (const JsonValue& element : *value->array()) {
    if (!element.text()) root.fail(name, "one element of it is " + described(element) + ", expected a text");
    result.push_back(*element.text());
  }
  return result;
}

const JsonValue::Array* array_of(const JsonValue& json, const std::string& file, const char* name) {
  const JsonValue* value = json.member(name);
  if (!value) return nullptr;
  if (!value->array()) throw SceneError(file + ": " + name, "is " + described(*value) + ", expected an array");
  return value->array();
}

}  // namespace

GltfFile::GltfFile(const Bundle& bundle, const std::filesystem::path& file, std::vector<std::string>& warnings)
    : bundle_(bundle), file_(file), name_(bundle.name(file)), bytes_(read_file(file, name_, kMaxMeshFileBytes)) {
  const std::string_view document = bytes_.starts_with("glTF") ? split_binary(bytes_) : std::string_view(bytes_);
  if (document.size() > kMaxSceneTextBytes) {
    throw SceneError(name_, "the document has " + std::to_string(document.size()) + " bytes, expected at most " +
                                std::to_string(kMaxSceneTextBytes));
  }
  json_ = parse_json(std::string(document), name_);
  check_document(warnings);
}

std::string_view GltfFile::split_binary(std::string_view bytes) {
  if (bytes.size() < kHeaderBytes + kChunkHeaderBytes) {
    throw SceneError(name_, "is cut off: it has " + std::to_string(bytes.size()) + " bytes, expected a header of " +
                                std::to_string(kHeaderBytes + kChunkHeaderBytes));
  }
  if (integer_at(bytes, 4) != 2)
    throw SceneError(name_, "is binary glTF of version " + std::to_string(integer_at(bytes, 4)) + ", expected 2");
  const std::size_t length = integer_at(bytes, 8);
  if (length > bytes.size()) {
    throw SceneError(name_,
                     "is cut off: it has " + std::to_string(bytes.size()) + " bytes, its header says " + std::to_string(length));
  }
  std::string_view document;
  std::size_t offset = kHeaderBytes;
  for (std::size_t chunk = 0; offset + kChunkHeaderBytes <= length; ++chunk) {
    const std::size_t size = integer_at(bytes, offset);
    const std::uint32_t type = integer_at(bytes, offset + 4);
    offset += kChunkHeaderBytes;
    if (size > length - offset) {
      throw SceneError(name_, "chunk " + std::to_string(chunk) + " has " + std::to_string(size) + " bytes, but only " +
                                  std::to_string(length - offset) + " are left");
    }
    const std::string_view data = bytes.substr(offset, size);
    if ((chunk == 0) != (type == kJsonChunk))
      throw SceneError(name_, "chunk " + std::to_string(chunk) + (chunk == 0 ? " is not JSON" : " is JSON, too") +
                                  ", expected the JSON first and once");
    if (chunk == 0) document = data;
    if (chunk == 1 && type == kBinaryChunk) {
      binary_ = data;
      has_binary_ = true;
    }
    offset += size;  // chunks of other types are skipped, as the specification asks
  }
  return document;
}

void GltfFile::check_document(std::vector<std::string>& warnings) const {
  const GltfObject document = root();
  const GltfObject asset = document.required_object("asset");
  const std::string version = asset.text("version", "");
  if (!version.starts_with("2.")) asset.fail("version", "expected \"2.0\"");
  if (asset.has("minVersion") && asset.text("minVersion", "") != "2.0") asset.fail("minVersion", "expected \"2.0\"");
  const std::vector<std::string> required = texts(document, "extensionsRequired");
  for (const std::string& extension : required) {
    if (known_extensions().contains(extension)) continue;
    const auto& known = known_extensions();
    throw SceneError(name_ + ": extensionsRequired", "the file requires " + in_quotes(extension) +
                                                         ", which is not read; read are: " + joined({known.begin(), known.end()}));
  }
  for (const std::string& extension : texts(document, "extensionsUsed")) {
    if (!known_extensions().contains(extension))
      warnings.push_back(name_ + ": extensionsUsed: " + in_quotes(extension) + " is not read; what it adds is missing");
  }
}

std::size_t GltfFile::size(const char* array) const {
  const JsonValue::Array* elements = array_of(json_, name_, array);
  return elements ? elements->size() : 0;
}

GltfObject GltfFile::at(const char* array, std::size_t index) const {
  const JsonValue::Array* elements = array_of(json_, name_, array);
  return {elements->at(index), name_ + ": " + array + "[" + std::to_string(index) + "]"};
}

std::filesystem::path GltfFile::find(const std::string& uri, const std::string& place) const {
  return bundle_.find_beside(file_, file_of_uri(uri, place), place);
}

std::string_view GltfFile::buffer(std::size_t index) {
  const GltfObject object = at("buffers", index);
  const std::uint64_t length = object.required_count("byteLength", kMaxMeshFileBytes);
  std::string_view data;
  if (const auto known = buffers_.find(index); known != buffers_.end()) {
    data = known->second;
  } else if (object.has("uri")) {
    const std::string uri = object.text("uri", ""), place = object.place() + ".uri";
    std::string bytes;
    if (is_data_uri(uri)) {
      bytes = data_uri_bytes(uri, place);
    } else {
      const std::filesystem::path file = find(uri, place);
      bytes = read_file(file, bundle_.name(file), kMaxMeshFileBytes);
    }
    buffer_bytes_ += bytes.size();
    if (buffer_bytes_ > kMaxMeshFileBytes)
      throw SceneError(place, "with this one the buffers have " + std::to_string(buffer_bytes_) + " bytes, expected at most " +
                                  std::to_string(kMaxMeshFileBytes));
    data = buffers_[index] = std::move(bytes);
  } else {
    if (index != 0 || !has_binary_) object.fail("uri", "expected one: the file has no binary chunk for this buffer");
    data = binary_;
  }
  if (data.size() < length)
    object.fail("byteLength", "but there are only " + std::to_string(data.size()) + " bytes: the data is cut off");
  return data.substr(0, length);
}

std::string_view GltfFile::buffer_view(std::size_t index) {
  const GltfObject object = at("bufferViews", index);
  const std::string_view data = buffer(object.required_index("buffer", "buffers", size("buffers")));
  const std::uint64_t offset = object.count("byteOffset", kMaxMeshFileBytes).value_or(0);
  const std::uint64_t length = object.required_count("byteLength", kMaxMeshFileBytes);
  if (offset > data.size() || length > data.size() - offset) {
    object.fail("byteLength", "with an offset of " + std::to_string(offset) + " it ends outside its buffer of " +
                                  std::to_string(data.size()) + " bytes");
  }
  return data.substr(offset, length);
}

}  // namespace fluxfarm
