#include "io/json_value.h"

#include <nlohmann/json.hpp>
#include <unordered_set>

#include "io/limits.h"
#include "io/text.h"
#include "support/error.h"

namespace fluxfarm {
namespace {

// Receives nlohmann's parse events and builds the value. The parser does not recurse, and the depth is checked before the
// value could become too deep to destroy.
class Builder {
 public:
  Builder(const std::string& text, const std::string& name) : text_(text), name_(name) {}

  bool null() { return put({nullptr}); }
  bool boolean(bool value) { return put({value}); }
  bool number_integer(std::int64_t value) { return put({value}); }
  bool number_unsigned(std::uint64_t value) {
    return value <= INT64_MAX ? put({static_cast<std::int64_t>(value)}) : put({static_cast<double>(value)});
  }
  bool number_float(double value, const std::string&) { return put({value}); }
  bool string(std::string& value) { return put({std::move(value)}); }
  bool binary(nlohmann::json::binary_t&) { return false; }
  bool start_object(std::size_t) { return open({JsonValue::Object{}}); }
  bool end_object() { return close(); }
  bool start_array(std::size_t) { return open({JsonValue::Array{}}); }
  bool end_array() { return close(); }

  bool key(std::string& name) {
    Level& level = open_.back();
    if (name.size() > kMaxNameLength)
      throw SceneError(name_ + ": " + path(), "the name " + in_quotes(name) + " of a member is too long");
    level.key = name;
    if (!level.keys.insert(name).second) throw SceneError(name_ + ": " + path(), "the member occurs twice");
    return true;
  }

  bool parse_error(std::size_t position, const std::string&, const nlohmann::json::exception& error) {
    std::size_t line = 1, column = 1;
    for (std::size_t i = 0; i + 1 < position && i < text_.size(); ++i) {
      column = text_[i] == '\n' ? 1 : column + 1;
      line += text_[i] == '\n';
    }
    // nlohmann's text reads "[json.exception.parse_error.101] parse error at line 1, column 2: what": keep what.
    std::string what = error.what();
    if (const std::size_t tail = what.find(": "); tail != std::string::npos) what = what.substr(tail + 2);
    throw SceneError(name_ + ":" + std::to_string(line), "column " + std::to_string(column) + ": is not JSON: " + printable(what));
  }

  JsonValue result() { return std::move(result_); }

 private:
  struct Level {
    JsonValue value;
    std::string key;  // of the member being read
    std::unordered_set<std::string> keys;
  };

  bool open(JsonValue value) {
    if (open_.size() >= static_cast<std::size_t>(kMaxNesting)) {
      throw SceneError(name_ + ": " + path(),
                       "objects and arrays are nested deeper than " + std::to_string(kMaxNesting) + " levels");
    }
    open_.push_back({std::move(value), {}, {}});
    return true;
  }

  bool close() {
    JsonValue value = std::move(open_.back().value);
    open_.pop_back();
    return put(std::move(value));
  }

  bool put(JsonValue value) {
    if (open_.empty()) {
      result_ = std::move(value);
    } else if (auto* array = std::get_if<JsonValue::Array>(&open_.back().value.value)) {
      array->push_back(std::move(value));
    } else {
      std::get<JsonValue::Object>(open_.back().value.value).push_back({open_.back().key, std::move(value)});
    }
    return true;
  }

  // Members that lead to the place being read, cut after a few.
  std::string path() const {
    constexpr std::size_t kShown = 6;
    std::string result;
    for (std::size_t i = 0; i < std::min(open_.size(), kShown); ++i) {
      if (const auto* array = open_[i].value.array()) {
        result += "[" + std::to_string(array->size()) + "]";
      } else {
        result += (result.empty() ? "" : ".") + open_[i].key;
      }
    }
    return open_.size() > kShown ? result + "..." : result;
  }

  const std::string& text_;
  const std::string& name_;
  std::vector<Level> open_;
  JsonValue result_;
};

}  // namespace

const JsonValue* JsonValue::member(const std::string& name) const {
  if (const Object* members = object()) {
    for (const JsonMember& each : *members) {
      if (each.name == name) return &each.value;
    }
  }
  return nullptr;
}

std::string described(const JsonValue& json) {
  struct Describe {
    std::string operator()(std::nullptr_t) const { return "null"; }
    std::string operator()(bool value) const { return value ? "true" : "false"; }
    std::string operator()(std::int64_t value) const { return std::to_string(value); }
    std::string operator()(double value) const { return number_text(value); }
    std::string operator()(const std::string& value) const { return "the text " + in_quotes(value); }
    std::string operator()(const JsonValue::Array& value) const {
      return "an array of " + std::to_string(value.size()) + " elements";
    }
    std::string operator()(const JsonValue::Object&) const { return "an object"; }
  };
  return std::visit(Describe{}, json.value);
}

JsonValue parse_json(const std::string& text, const std::string& name) {
  Builder builder(text, name);
  nlohmann::json::sax_parse(text, &builder);
  return builder.result();
}

}  // namespace fluxfarm
