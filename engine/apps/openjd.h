// How far a render is, as lines that programs which run Open Job Description sessions read from standard output (OpenCue, Flamenco
// and Deadline Cloud have such): "openjd_progress: PERCENT", "openjd_status: TEXT", "openjd_fail: TEXT".
//
// [OpenJD] Open Job Description, "How Jobs Are Run", messages of an action's standard output.
#pragma once

#include "film/goal.h"
#include "worker/frame_renderer.h"

namespace fluxfarm {

class OpenJdLines {
 public:
  explicit OpenJdLines(const Goal& goal) : goal_(goal) {}

  // Progress never falls; it is 100 only when the image is there.
  void progress(const TimelinePoint& point);
  static void done();
  static void fail(const char* why);

 private:
  // Part of the work that is done, 0 to 1.
  double part(const TimelinePoint& point) const;

  Goal goal_;
  double most_ = 0;
};

}  // namespace fluxfarm
