#include "tools/bench/mapping/gauges.hpp"

#include <malloc.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <string>

namespace curbstone::bench::mapping {
namespace {

/// The number in size="..." of the last element of this name in malloc_info()'s text; 0 if there is none.
double last_size(const std::string& info, const char* element) {
  const std::size_t found = info.rfind(element);
  if (found == std::string::npos) return 0;
  const std::size_t size = info.find("size=\"", found);
  return size == std::string::npos ? 0 : std::strtod(info.c_str() + size + 6, nullptr);
}

}  // namespace

double now_ms(clockid_t clock) {
  timespec t{};
  clock_gettime(clock, &t);
  return static_cast<double>(t.tv_sec) * 1e3 + static_cast<double>(t.tv_nsec) * 1e-6;
}

double heap_mb() {
  char* text = nullptr;
  std::size_t size = 0;
  std::FILE* out = open_memstream(&text, &size);
  if (out == nullptr) return 0;
  malloc_info(0, out);
  std::fclose(out);
  const std::string info(text, size);
  std::free(text);  // NOLINT: allocated by open_memstream
  // The sums over all arenas come last.
  const double held = last_size(info, "<system type=\"current\"") + last_size(info, "<total type=\"mmap\"");
  const double unused = last_size(info, "<total type=\"fast\"") + last_size(info, "<total type=\"rest\"");
  return (held - unused) / 1e6;
}

double resident_mb() {
  std::ifstream in("/proc/self/statm");
  double size = 0, resident = 0;  // pages
  in >> size >> resident;
  return in ? resident * static_cast<double>(sysconf(_SC_PAGESIZE)) / 1e6 : 0;
}

}  // namespace curbstone::bench::mapping
