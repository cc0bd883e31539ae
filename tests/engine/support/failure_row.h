// What a test has measured of a known failure, for the page of failures (docs/failures.md, tests/stability/failure_table.py).
#pragma once

#include <gtest/gtest.h>

#include <cstdio>
#include <string>

#include "support/scene_builder.h"
#include "worker/pilot.h"

namespace fluxfarm::testing {

inline std::string percent(double share, const char* format = "%+.1f %%") {
  char text[32];
  std::snprintf(text, sizeof text, format, 100 * share);
  return text;
}

// Fills a column of the row of that key: "off", "on" or "auto".
inline void tell_failure(const std::string& key, const std::string& column, const std::string& value) {
  ::testing::Test::RecordProperty("failure " + key + " " + column, value);
}

// What "auto" does with a scene towards an error: which method it takes, and what the job says in the end.
inline std::string told_by_auto(const SceneDescription& description, double rel_error) {
  const Scene scene(description, 1);
  const PixelRect frame{0, 0, description.film.width, description.film.height};
  const Goal goal{{}, {}, rel_error};
  const Method method = make_method("auto", scene, {frame, 1, goal}, 1, kNever);
  const FrameResult result = render_frame(scene, *method.integrator, {frame, 64, 1, 1, goal}, kNever, {}, method.known);
  const std::string end =
      result.warnings.empty() ? "claims " + percent(rel_error, "%.0f %%") : "says \"" + result.warnings[0] + "\"";
  return method.choice->method + ", " + end;
}

}  // namespace fluxfarm::testing
