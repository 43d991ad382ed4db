#pragma once

#include <cstdint>

namespace curbstone {

/// Resident memory of this process, bytes.
struct ProcessMemory {
  std::int64_t resident = 0;
  std::int64_t own = 0;  ///< without pages of files, which processes with the same programs and libraries share
};
[[nodiscard]] ProcessMemory process_memory();

/// All threads allocate from one heap. By default glibc gives each thread one of its own, and what one thread allocates
/// and another one frees leaves holes in it: up to a quarter of a process that passes its data from thread to thread.
/// To be called before the first thread starts.
void use_one_heap();

/// Gives memory that the process has freed back to the system, if it is 32 MB or more. glibc keeps what was freed
/// between blocks in use: a service would keep for ever what it needed once, such as all tiles of a map whose loop is
/// closed. Returns the bytes given back. Any thread; those that allocate may wait for it, the longer the more is free.
std::int64_t return_unused_memory();

}  // namespace curbstone
