// A file of recorded CAN frames, candump's or PCAN's.
#include <stdexcept>

#include "drivers/encoder/traces/trace_file.hpp"
#include "tests/fuzz/support/memory_file.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace curbstone;
  const fuzz::MemoryFile file({data, size});
  try {
    encoder::traces::TraceFile trace(file.name());
    while (const auto frame = trace.next()) {
      fuzz::require(frame->frame.size <= 8, "a frame has at most 8 bytes");
      fuzz::require(frame->frame.id <= 0x1FFFFFFF, "an id has at most 29 bits");
    }
  } catch (const std::runtime_error&) {
    // Not such a file, and said so.
  }
  return 0;
}
