// An LCM log of any bytes.
#include <stdexcept>

#include "common/log/log_reader.hpp"
#include "tests/fuzz/support/memory_file.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace curbstone;
  const fuzz::MemoryFile file({data, size});
  try {
    LogReader log(file.name());
    std::size_t bytes = 0;
    while (const auto event = log.next()) {
      bytes += event->bytes.size() + event->channel.size();
      fuzz::require(bytes <= size, "no message is made up");
      fuzz::require(log.progress() >= 0 && log.progress() <= 1, "progress is a part");
    }
    const auto lost = log.loss().bytes + log.loss().cut_off;
    fuzz::require(lost >= 0 && bytes + static_cast<std::size_t>(lost) <= size, "what was skipped is in the file");
  } catch (const std::runtime_error&) {
    // No log, and said so.
  }
  return 0;
}
