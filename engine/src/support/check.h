// FLUXFARM_CHECK stops the process when an invariant of the engine is broken, and says where.
#pragma once

#include <cstdio>
#include <cstdlib>

// Always on, also in release builds: keep it out of inner loops.
#define FLUXFARM_CHECK(condition, message)                                                                 \
  do {                                                                                                     \
    if (!(condition)) {                                                                                    \
      std::fprintf(stderr, "%s:%d: broken invariant: %s (%s)\n", __FILE__, __LINE__, #condition, message); \
      std::abort();                                                                                        \
    }                                                                                                      \
  } while (false)
