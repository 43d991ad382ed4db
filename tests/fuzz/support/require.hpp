#pragma once

#include <cstdio>
#include <cstdlib>

namespace curbstone::fuzz {

/// What must hold whatever came in; a finding where it does not.
inline void require(bool holds, const char* what) {
  if (holds) return;
  std::fprintf(stderr, "does not hold: %s\n", what);
  std::abort();
}

}  // namespace curbstone::fuzz
