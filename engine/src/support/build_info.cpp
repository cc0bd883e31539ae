#include "support/build_info.h"

namespace fluxfarm {

std::string engine_version() { return FLUXFARM_VERSION; }

std::string compiler() {
#if defined(__clang__)
  return std::string("clang ") + __clang_version__;
#else
  return std::string("gcc ") + __VERSION__;
#endif
}

std::string build_options() { return FLUXFARM_BUILD_OPTIONS; }

std::string instruction_set() {
#if defined(__AVX512F__)
  return "AVX-512";
#elif defined(__AVX2__)
  return "AVX2";
#elif defined(__SSE4_2__)
  return "SSE4.2";
#elif defined(__SSE2__)
  return "SSE2";
#else
  return "baseline";
#endif
}

std::string engine_build() {
  return engine_version() + " " + FLUXFARM_SOURCE_DIGEST + " " + compiler() + " " + instruction_set() + " " + build_options();
}

}  // namespace fluxfarm
