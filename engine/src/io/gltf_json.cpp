#include "io/gltf_json.h"

#include <cmath>

#include "io/json_values.h"
#include "io/text.h"
#include "support/error.h"

namespace fluxfarm {
namespace {

bool is_inside(double value, const NumberRange& range) {
  if (!std::isfinite(value)) return false;
  return range.open ? value > range.min && value < range.max : value >= range.min && value <= range.max;
}

std::string expected(const NumberRange& range) {
  if (!std::isfinite(range.min) && !std::isfinite(range.max)) return "a finite number";
  if (!std::isfinite(range.max))
    return std::string("a number ") + (range.open ? "greater than " : "of at least ") + number_text(range.min);
  return "a number in " + std::string(range.open ? "(" : "[") + number_text(range.min) + ", " + number_text(range.max) +
         (range.open ? ")" : "]");
}

}  // namespace

GltfObject::GltfObject(const JsonValue& json, std::string place) : json_(&json), place_(std::move(place)) {
  if (!json.object()) throw SceneError(place_, "is " + described(json) + ", expected an object");
}

void GltfObject::fail(const char* name, const std::string& what) const {
  const JsonValue* value = json_->member(name);
  throw SceneError(place_ + "." + name, (value ? "is " + described(*value) + ", " : std::string("is missing, ")) + what);
}

const JsonValue* GltfObject::find(const char* name, bool required) const {
  const JsonValue* value = json_->member(name);
  if (!value && required) fail(name, "expected it here");
  return value;
}

double GltfObject::number(const char* name, double otherwise, NumberRange range) const {
  const JsonValue* value = find(name, false);
  if (!value) return otherwise;
  const std::optional<double> number = json_number(*value);
  if (!number || !is_inside(*number, range)) fail(name, "expected " + expected(range));
  return *number;
}

bool GltfObject::boolean(const char* name, bool otherwise) const {
  const JsonValue* value = find(name, false);
  if (!value) return otherwise;
  const bool* boolean = std::get_if<bool>(&value->value);
  if (!boolean) fail(name, "expected true or false");
  return *boolean;
}

std::string GltfObject::text(const char* name, const std::string& otherwise) const {
  const JsonValue* value = find(name, false);
  if (!value) return otherwise;
  if (!value->text()) fail(name, "expected a text");
  return *value->text();
}

std::vector<double> GltfObject::numbers(const char* name, std::size_t size, const std::vector<double>& otherwise,
                                        NumberRange range) const {
  const JsonValue* value = find(name, false);
  if (!value) return otherwise;
  const JsonValue::Array* array = value->array();
  if (!array || array->size() != size) fail(name, "expected " + std::to_string(size) + " numbers");
  std::vector<double> result;
  for (std::size_t i = 0; i < size; ++i) {
    const std::optional<double> number = json_number((*array)[i]);
    if (!number || !is_inside(*number, range)) {
      throw SceneError(place_ + "." + name + "[" + std::to_string(i) + "]",
                       "is " + described((*array)[i]) + ", expected " + expected(range));
    }
    result.push_back(*number);
  }
  return result;
}

std::optional<std::uint64_t> GltfObject::count(const char* name, std::uint64_t limit) const {
  const JsonValue* value = find(name, false);
  if (!value) return std::nullopt;
  // Some exporters write integers as 1.0.
  const std::optional<double> number = json_number(*value);
  if (!number || *number != std::floor(*number) || *number < 0 || *number > static_cast<double>(limit))
    fail(name, "expected an integer in [0, " + std::to_string(limit) + "]");
  return static_cast<std::uint64_t>(*number);
}

std::uint64_t GltfObject::required_count(const char* name, std::uint64_t limit) const {
  find(name, true);
  return *count(name, limit);
}

std::optional<std::size_t> GltfObject::index(const char* name, const char* array, std::size_t size) const {
  const JsonValue* value = find(name, false);
  if (!value) return std::nullopt;
  const auto* integer = std::get_if<std::int64_t>(&value->value);
  if (!integer || *integer < 0 || static_cast<std::uint64_t>(*integer) >= size) {
    fail(name, "expected an index into " + std::string(array) + ", which has " + std::to_string(size) + " elements");
  }
  return static_cast<std::size_t>(*integer);
}

std::size_t GltfObject::required_index(const char* name, const char* array, std::size_t size) const {
  find(name, true);
  return *index(name, array, size);
}

std::optional<GltfObject> GltfObject::object(const char* name) const {
  const JsonValue* value = find(name, false);
  if (!value) return std::nullopt;
  return GltfObject(*value, place_ + "." + name);
}

GltfObject GltfObject::required_object(const char* name) const { return {*find(name, true), place_ + "." + name}; }

std::vector<GltfObject> GltfObject::objects(const char* name) const {
  const JsonValue* value = find(name, false);
  if (!value) return {};
  if (!value->array()) fail(name, "expected an array of objects");
  std::vector<GltfObject> result;
  for (const JsonValue& element : *value->array())
    result.emplace_back(element, place_ + "." + name + "[" + std::to_string(result.size()) + "]");
  return result;
}

std::optional<GltfObject> GltfObject::extension(const char* name) const {
  const std::optional<GltfObject> extensions = object("extensions");
  return extensions ? extensions->object(name) : std::nullopt;
}

std::vector<std::size_t> GltfObject::indices(const char* name, const char* array, std::size_t size) const {
  const JsonValue* value = find(name, false);
  if (!value) return {};
  if (!value->array()) fail(name, "expected an array of indices into " + std::string(array));
  std::vector<std::size_t> result;
  for (const JsonValue& element : *value->array()) {
    const auto* integer = std::get_if<std::int64_t>(&element.value);
    if (!integer || *integer < 0 || static_cast<std::uint64_t>(*integer) >= size) {
      throw SceneError(
          place_ + "." + name + "[" + std::to_string(result.size()) + "]",
          "is " + described(element) + ", expected an index into " + array + ", which has " + std::to_string(size) + " elements");
    }
    result.push_back(static_cast<std::size_t>(*integer));
  }
  return result;
}

}  // namespace fluxfarm
