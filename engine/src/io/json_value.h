// A JSON document as plain values that keep the order of members; parsed with limits on depth and without duplicate members.
#pragma once

#include <cstdint>
#include <string>
#include <variant>
#include <vector>

namespace fluxfarm {

struct JsonMember;

struct JsonValue {
  using Array = std::vector<JsonValue>;
  using Object = std::vector<JsonMember>;

  std::variant<std::nullptr_t, bool, std::int64_t, double, std::string, Array, Object> value;

  const Array* array() const { return std::get_if<Array>(&value); }
  const Object* object() const { return std::get_if<Object>(&value); }
  const std::string* text() const { return std::get_if<std::string>(&value); }
  // The member of that name of an object, or nullptr.
  const JsonValue* member(const std::string& name) const;
};

struct JsonMember {
  std::string name;
  JsonValue value;
};

// "an array", "the text \"x\"", "true", as messages name a value.
std::string described(const JsonValue& value);

// Throws SceneError for text that is no JSON (with line and column), for nesting deeper than kMaxNesting and for a member that
// occurs twice (with the path of the member). `name` is the file as messages show it.
JsonValue parse_json(const std::string& text, const std::string& name);

}  // namespace fluxfarm
