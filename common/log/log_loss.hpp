#pragma once

#include <cstdint>
#include <string>

namespace curbstone {

/// What of a log could not be read.
struct LogLoss {
  std::int64_t places = 0;   ///< where something else than a record stands
  std::int64_t bytes = 0;    ///< skipped there
  std::int64_t missing = 0;  ///< records that their numbers say stood there, as far as the numbers are whole
  double seconds = 0;        ///< from the records before to those behind
  std::int64_t cut_off = 0;  ///< bytes of a last record that the end of the file cuts off: its writer was stopped

  [[nodiscard]] bool damaged() const { return places > 0; }
  LogLoss& operator+=(const LogLoss& other);
};

/// "damaged at 2 places: 1234 bytes skipped, 3 messages, 0.02 s"; with a last message cut off, says so. Empty: nothing.
[[nodiscard]] std::string to_text(const LogLoss& loss);

}  // namespace curbstone
