#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "drivers/encoder/can/can_frame.hpp"

namespace curbstone::encoder::traces {

/// Parses the lines of a PCAN trace of version 1.1, 2.0 or 2.1, in order: the first lines define the format of the
/// others. Source: PEAK CAN TRC File Format (2020). Pure.
class PcanTrace {
 public:
  struct Line {
    enum class Kind {
      kFrame,
      kComment,  ///< heading, comment, empty line
      kOther,    ///< error frame, CAN FD, bus state, event: no classical frame
      kRefused,  ///< not a line of such a file
    } kind = Kind::kRefused;
    std::int64_t utime = 0;  ///< us; the file's start is local time, and is taken as UTC
    std::string bus;         ///< empty if the file does not name it
    can::CanFrame frame;
  };

  [[nodiscard]] Line parse(std::string_view line);
  /// A version that is not supported, "1.3"; empty otherwise.
  [[nodiscard]] const std::string& foreign_version() const { return foreign_version_; }

 private:
  void on_keyword(std::string_view line);

  std::string columns_ = "NOTILD";  ///< one letter each; those of version 1.1
  bool old_ = true;                 ///< version 1.1: types are Rx, Tx; a remote frame says RTR
  std::int64_t start_ = 0;          ///< us since the Unix epoch
  std::string foreign_version_;
};

}  // namespace curbstone::encoder::traces
