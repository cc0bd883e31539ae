// A glTF 2.0 file and what belongs to it: the document, and the bytes of its buffers, each opened when first asked for.
//
// Binary (.glb) and text (.gltf) files are told apart by their first bytes. Extensions that a file requires and that we do not read
// are errors.
//
// [glTF] Khronos, "glTF 2.0 Specification", version 2.0.1, 2021 (ISO/IEC 12113:2022).
#pragma once

#include <filesystem>
#include <map>
#include <string_view>

#include "io/bundle.h"
#include "io/gltf_json.h"

namespace fluxfarm {

class GltfFile {
 public:
  // `file` was found by `bundle`, which must outlive this. Adds a line to `warnings` for each extension in use that is not read.
  // Throws SceneError.
  GltfFile(const Bundle& bundle, const std::filesystem::path& file, std::vector<std::string>& warnings);
  GltfFile(const GltfFile&) = delete;
  GltfFile& operator=(const GltfFile&) = delete;

  const std::string& name() const { return name_; }  // as messages show it
  GltfObject root() const { return {json_, name_}; }
  // Elements of an array of the document: "meshes".
  std::size_t size(const char* array) const;
  GltfObject at(const char* array, std::size_t index) const;

  // The bytes of a buffer view; valid while this lives. Throws SceneError if they lie outside their buffer.
  std::string_view buffer_view(std::size_t index);
  // The file that `uri`, which stands at `place`, names; relative to this one.
  std::filesystem::path find(const std::string& uri, const std::string& place) const;

 private:
  std::string_view split_binary(std::string_view bytes);
  void check_document(std::vector<std::string>& warnings) const;
  std::string_view buffer(std::size_t index);

  const Bundle& bundle_;
  std::filesystem::path file_;
  std::string name_;
  std::string bytes_;        // the whole file; binary_ is a part of it
  std::string_view binary_;  // the BIN chunk
  bool has_binary_ = false;
  JsonValue json_;
  std::map<std::size_t, std::string> buffers_;  // read so far
  std::uintmax_t buffer_bytes_ = 0;             // of all of them
};

}  // namespace fluxfarm
