// The objects of a glTF document with the place where each stands, read member by member.
//
// Unlike Mitsuba's plugins, glTF objects may have members that the reader does not know (`extras`, extensions): they are skipped.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "io/json_value.h"
#include "io/properties.h"

namespace fluxfarm {

class GltfObject {
 public:
  // `place` as in "a.glb: meshes[2]"; `json` must outlive this. Throws SceneError unless it is an object.
  GltfObject(const JsonValue& json, std::string place);

  bool has(const char* name) const { return json_->member(name) != nullptr; }

  // Each throws SceneError if the member has the wrong type or lies outside the range.
  double number(const char* name, double otherwise, NumberRange range = kAnyNumber) const;
  bool boolean(const char* name, bool otherwise) const;
  std::string text(const char* name, const std::string& otherwise) const;
  // Exactly `size` numbers; `otherwise` if the member is absent.
  std::vector<double> numbers(const char* name, std::size_t size, const std::vector<double>& otherwise,
                              NumberRange range = kAnyNumber) const;
  // An integer in [0, limit]. Nothing if absent.
  std::optional<std::uint64_t> count(const char* name, std::uint64_t limit) const;
  std::uint64_t required_count(const char* name, std::uint64_t limit) const;
  // An index below `size`, where `array` names the array that it points into. Nothing if absent.
  std::optional<std::size_t> index(const char* name, const char* array, std::size_t size) const;
  std::size_t required_index(const char* name, const char* array, std::size_t size) const;

  std::optional<GltfObject> object(const char* name) const;
  GltfObject required_object(const char* name) const;
  std::vector<GltfObject> objects(const char* name) const;  // the elements of an array; none if absent
  std::optional<GltfObject> extension(const char* name) const;
  // The indices of an array of them, each below `size`.
  std::vector<std::size_t> indices(const char* name, const char* array, std::size_t size) const;

  const std::string& place() const { return place_; }
  const JsonValue& json() const { return *json_; }
  [[noreturn]] void fail(const char* name, const std::string& what) const;

 private:
  const JsonValue* find(const char* name, bool required) const;

  const JsonValue* json_;
  std::string place_;
};

}  // namespace fluxfarm
