// Typed errors for bad input, thrown low and caught once (apps and worker/task_runner).
//
// A broken invariant of the engine is not an error of this kind: see check.h.
#pragma once

#include <stdexcept>
#include <string>

namespace fluxfarm {

// Base of every error that the input or the machine can cause. what() is one sentence: what, where, value, what would be right.
class Error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// The scene, or a file that belongs to it, is wrong. Trying again is useless.
class SceneError : public Error {
 public:
  using Error::Error;
  // `where` names file and place, for example "scene.xml:12".
  SceneError(const std::string& where, const std::string& what) : Error(where + ": " + what) {}
};

// A setting or a command-line option makes no sense.
class SettingError : public Error {
 public:
  using Error::Error;
};

// The machine could not do it: a file that cannot be written, memory that is not there.
class ResourceError : public Error {
 public:
  using Error::Error;
};

// The work was ended on request.
class CancelledError : public Error {
 public:
  CancelledError() : Error("cancelled") {}
};

}  // namespace fluxfarm
