#pragma once

#include <cstdint>
#include <string>

namespace curbstone {

/// The parts of a log that could not be read.
struct LogLoss {
  std::int64_t places = 0;   ///< places that do not hold a record
  std::int64_t bytes = 0;    ///< skipped there
  std::int64_t missing = 0;  ///< records missing there by the record numbers, as far as these are intact
  double seconds = 0;        ///< between the records before and after such places
  std::int64_t cut_off = 0;  ///< bytes of a last record that is cut off by the end of the file: its writer was stopped

  [[nodiscard]] bool damaged() const { return places > 0; }
  LogLoss& operator+=(const LogLoss& other);
};

/// "damaged at 2 places: 1234 bytes skipped, 3 messages, 0.02 s"; also mentions a last message that is cut off. Empty
/// if nothing was lost.
[[nodiscard]] std::string to_text(const LogLoss& loss);

}  // namespace curbstone
