#include "openjd.h"

#include <algorithm>
#include <cstdio>
#include <string>

namespace fluxfarm {
namespace {

void say(const char* name, const std::string& value) {
  std::printf("openjd_%s: %s\n", name, value.c_str());
  std::fflush(stdout);
}

std::string in_line(std::string text) {
  std::ranges::replace_if(
      text, [](char c) { return static_cast<unsigned char>(c) < ' '; }, ' ');
  return text;
}

std::string formatted(const char* format, double value) {
  char text[32];
  std::snprintf(text, sizeof text, format, value);
  return text;
}

}  // namespace

void OpenJdLines::progress(const TimelinePoint& point) {
  most_ = std::max(most_, std::clamp(part(point), 0.0, 0.999));
  say("progress", formatted("%.1f", 100 * most_));
  const std::string error = point.error ? "error " + formatted("%.3g", *point.error) : "no error yet";
  say("status", error + ", " + formatted("%.6g", point.spp) + " samples a pixel, " + formatted("%.1f", point.seconds) + " s");
}

void OpenJdLines::done() { say("progress", "100.0"); }

void OpenJdLines::fail(const char* why) { say("fail", in_line(why)); }

double OpenJdLines::part(const TimelinePoint& point) const {
  if (goal_.spp) return point.spp / static_cast<double>(*goal_.spp);
  if (goal_.seconds) return point.seconds / *goal_.seconds;
  return point.expected_spp ? point.spp / *point.expected_spp : 0;
}

}  // namespace fluxfarm
