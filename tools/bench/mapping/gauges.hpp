#pragma once

#include <time.h>

namespace curbstone::bench::mapping {

/// ms: CLOCK_MONOTONIC for the wall, CLOCK_PROCESS_CPUTIME_ID for what the process used.
[[nodiscard]] double now_ms(clockid_t clock);
/// MB of heap in use in the whole process, whichever thread asked for them (glibc only, else 0).
[[nodiscard]] double heap_mb();
/// MB of the process that lie in memory (Linux only, else 0).
[[nodiscard]] double resident_mb();

}  // namespace curbstone::bench::mapping
