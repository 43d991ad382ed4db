#pragma once

#include <time.h>

namespace curbstone::bench::mapping {

/// ms: CLOCK_MONOTONIC for wall time, CLOCK_PROCESS_CPUTIME_ID for CPU time of the process.
[[nodiscard]] double now_ms(clockid_t clock);
/// MB of heap in use by all threads of the process (glibc only, else 0).
[[nodiscard]] double heap_mb();
/// MB of resident memory of the process (Linux only, else 0).
[[nodiscard]] double resident_mb();

}  // namespace curbstone::bench::mapping
