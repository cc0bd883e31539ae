#include "io/json_values.h"

#include <algorithm>

#include "io/text.h"
#include "io/transform_steps.h"
#include "support/error.h"

namespace fluxfarm {
namespace {

// The numbers of a flat array, or nothing.
std::optional<std::vector<double>> json_numbers(const JsonValue& json) {
  const JsonValue::Array* array = json.array();
  if (!array) return std::nullopt;
  std::vector<double> numbers;
  for (const JsonValue& element : *array) {
    const std::optional<double> number = json_number(element);
    if (!number) return std::nullopt;
    numbers.push_back(*number);
  }
  return numbers;
}

// The member of a step or a colour that must be there.
const JsonValue& required(const JsonValue& json, const std::string& name, const std::string& place) {
  if (const JsonValue* value = json.member(name)) return *value;
  throw SceneError(place, "lacks the member " + in_quotes(name));
}

void check_members(const JsonValue& json, const std::vector<std::string>& allowed, const std::string& place) {
  for (const JsonMember& member : *json.object()) {
    if (std::find(allowed.begin(), allowed.end(), member.name) == allowed.end()) {
      throw SceneError(place, "has no member " + in_quotes(member.name) + "; it takes " + joined(allowed));
    }
  }
}

Triple read_triple(const JsonValue& json, const std::string& place) {
  const auto numbers = json_numbers(json);
  if (!numbers || numbers->size() != 3) throw SceneError(place, "is " + described(json) + ", expected three numbers");
  return {(*numbers)[0], (*numbers)[1], (*numbers)[2]};
}

double read_number(const JsonValue& json, const std::string& place) {
  if (const auto number = json_number(json)) return *number;
  throw SceneError(place, "is " + described(json) + ", expected a number");
}

// One number for all three axes, or three.
Triple read_one_or_three(const JsonValue& json, const std::string& place) {
  if (const auto number = json_number(json)) return {*number, *number, *number};
  return read_triple(json, place);
}

// The 16 numbers of four rows of four.
std::vector<double> read_rows(const JsonValue& json, const std::string& place) {
  std::vector<double> numbers;
  const JsonValue::Array* rows = json.array();
  for (std::size_t i = 0; rows && rows->size() == 4 && i < 4; ++i) {
    const auto row = json_numbers((*rows)[i]);
    if (!row || row->size() != 4) break;
    numbers.insert(numbers.end(), row->begin(), row->end());
  }
  if (numbers.size() != 16) throw SceneError(place, "is " + described(json) + ", expected a matrix of four rows of four numbers");
  return numbers;
}

Transform read_step(const JsonValue& json, const std::string& place) {
  const std::string* type = json.member("type") ? json.member("type")->text() : nullptr;
  if (!type) throw SceneError(place, "is no step of a transform, expected an object with a \"type\"");
  if (*type == "translate" || *type == "scale") {
    check_members(json, {"type", "value"}, place);
    const JsonValue& value = required(json, "value", place);
    const Triple v = *type == "scale" ? read_one_or_three(value, place + ".value") : read_triple(value, place + ".value");
    return *type == "scale" ? Transform::scale(v[0], v[1], v[2]) : Transform::translate(v[0], v[1], v[2]);
  }
  if (*type == "rotate") {
    check_members(json, {"type", "axis", "angle"}, place);
    return rotate_step(read_triple(required(json, "axis", place), place + ".axis"),
                       read_number(required(json, "angle", place), place + ".angle"), place);
  }
  if (*type == "lookat" || *type == "look_at") {
    check_members(json, {"type", "origin", "target", "up"}, place);
    const JsonValue* up = json.member("up");
    return look_at_step(read_triple(required(json, "origin", place), place + ".origin"),
                        read_triple(required(json, "target", place), place + ".target"),
                        up ? read_triple(*up, place + ".up") : Triple{0, 1, 0}, place);
  }
  if (*type == "matrix") {
    check_members(json, {"type", "value"}, place);
    return matrix_step(read_rows(required(json, "value", place), place + ".value"), place);
  }
  throw SceneError(place, "unknown step " + in_quotes(*type) + ", expected translate, scale, rotate, lookat or matrix");
}

// Steps in the order in which they are applied.
Transform read_transform(const JsonValue& json, const std::string& place) {
  const JsonValue::Array& array = *json.array();
  Transform result;
  if (!array.empty() && array[0].array()) {
    result = matrix_step(read_rows(json, place), place);
  } else {
    for (std::size_t i = 0; i < array.size(); ++i) result = read_step(array[i], place + "[" + std::to_string(i) + "]") * result;
  }
  if (!result.is_finite()) throw SceneError(place, "gives a matrix with infinite or NaN numbers");
  return result;
}

PropertyValue read_colour(const JsonValue& json, const std::string& type, const std::string& place) {
  check_members(json, {"type", "value"}, place);
  const JsonValue& value = required(json, "value", place);
  if (type == "spectrum") return UniformSpectrum{read_number(value, place + ".value")};
  const Triple v = read_one_or_three(value, place + ".value");
  return Rgb{static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2])};
}

}  // namespace

std::optional<double> json_number(const JsonValue& json) {
  if (const auto* integer = std::get_if<std::int64_t>(&json.value)) return static_cast<double>(*integer);
  if (const auto* number = std::get_if<double>(&json.value)) return *number;
  return std::nullopt;
}

PropertyValue read_json_value(const JsonValue& json, const std::string& place) {
  if (const auto* value = std::get_if<bool>(&json.value)) return *value;
  if (const auto* value = std::get_if<std::int64_t>(&json.value)) return *value;
  if (const auto* value = std::get_if<double>(&json.value)) return *value;
  if (const std::string* value = json.text()) return *value;
  if (json.object()) {
    const std::string* type = json.member("type") ? json.member("type")->text() : nullptr;
    if (type && (*type == "rgb" || *type == "spectrum")) return read_colour(json, *type, place);
  }
  if (json_numbers(json) && json.array()->size() == 3) return read_triple(json, place);
  if (json.array() && !json_numbers(json)) return read_transform(json, place);
  throw SceneError(place, "is " + described(json) + ", expected a number, a text, true, false, three numbers or a plugin");
}

}  // namespace fluxfarm
