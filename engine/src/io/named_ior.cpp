// Source: the names and values of Mitsuba 3 (checked against 3.6.4), which took them from public tables of optics.
#include "io/named_ior.h"

#include <cctype>

namespace fluxfarm {
namespace {

struct Row {
  std::string_view name;
  float ior;
};

constexpr Row kRows[] = {
    {"vacuum", 1.0f},
    {"helium", 1.000036f},
    {"hydrogen", 1.000132f},
    {"air", 1.000277f},
    {"carbon dioxide", 1.00045f},
    {"water ice", 1.31f},
    {"water", 1.333f},
    {"acetone", 1.36f},
    {"ethanol", 1.361f},
    {"fused quartz", 1.458f},
    {"carbon tetrachloride", 1.461f},
    {"pyrex", 1.47f},
    {"glycerol", 1.4729f},
    {"acrylic glass", 1.49f},
    {"polypropylene", 1.49f},
    {"benzene", 1.501f},
    {"bk7", 1.5046f},
    {"silicone oil", 1.52045f},
    {"sodium chloride", 1.544f},
    {"amber", 1.55f},
    {"pet", 1.575f},
    {"bromine", 1.661f},
    {"diamond", 2.419f},
};

}  // namespace

std::optional<float> named_ior(std::string_view name) {
  std::string lower;
  for (const char c : name) lower += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  for (const Row& row : kRows) {
    if (row.name == lower) return row.ior;
  }
  return std::nullopt;
}

std::vector<std::string> ior_names() {
  std::vector<std::string> names;
  for (const Row& row : kRows) names.emplace_back(row.name);
  return names;
}

}  // namespace fluxfarm
