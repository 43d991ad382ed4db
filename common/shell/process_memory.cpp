#include "common/shell/process_memory.hpp"

#include <malloc.h>
#include <unistd.h>

#include <fstream>

namespace curbstone {

namespace {
constexpr std::int64_t kMuch = 32'000'000;  // bytes: less is needed again soon
}  // namespace

ProcessMemory process_memory() {
  std::ifstream statm("/proc/self/statm");
  std::int64_t total = 0, resident = 0, of_files = 0;
  statm >> total >> resident >> of_files;
  const std::int64_t page = sysconf(_SC_PAGESIZE);
  return {resident * page, (resident - of_files) * page};
}

void use_one_heap() {
  mallopt(M_ARENA_MAX, 1);
}

std::int64_t return_unused_memory() {
  const std::int64_t before = process_memory().own;
  // What malloc calls free may have been given back already, so it is no measure: what is resident and not in use is.
  const struct mallinfo2 heap = mallinfo2();
  const auto in_use = static_cast<std::int64_t>(heap.uordblks + heap.hblkhd);
  if (before - in_use < kMuch) return 0;
  malloc_trim(0);
  return before - process_memory().own;
}

}  // namespace curbstone
