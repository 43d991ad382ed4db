#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "drivers/encoder/can/can_frame.hpp"

namespace curbstone::encoder::traces {

/// Parses the lines of a PCAN trace of version 1.0 to 1.3, 2.0, 2.1 or 3.0, in order: the first lines define the format
/// of the others. A file that names no version is of 1.0. Source: PEAK CAN TRC File Format (2020). Pure.
class PcanTrace {
 public:
  struct Line {
    enum class Kind {
      kFrame,
      kComment,  ///< heading, comment, empty line
      kOther,    ///< error frame, CAN FD, CAN XL, bus state, event, long J1939 message: no classical frame
      kRefused,  ///< not a line of such a file
    } kind = Kind::kRefused;
    std::int64_t utime = 0;  ///< us; the file's start is local time, and is taken as UTC
    std::string bus;         ///< empty if the file does not name it
    can::CanFrame frame;
  };

  [[nodiscard]] Line parse(std::string_view line);
  /// A version that is not supported, "4.0"; empty otherwise.
  [[nodiscard]] const std::string& foreign_version() const { return foreign_version_; }

 private:
  enum class Type { kData, kRemote, kOther };
  /// A line while its columns are read.
  struct Columns {
    Line line;
    Type type = Type::kData;
    bool addressed = false;  // J1939: to one address, and then of any length
  };
  void on_keyword(std::string_view line);
  [[nodiscard]] Type type_of(std::string_view word) const;
  [[nodiscard]] bool has_needed_columns() const;
  [[nodiscard]] static std::optional<Line::Kind> read_length(char column, std::string_view word, Columns& read);
  [[nodiscard]] std::optional<Line::Kind> read_column(char column, std::string_view word, Columns& read) const;
  [[nodiscard]] Line::Kind read_data(std::string_view text, Columns& read) const;

  std::string columns_ = "NOILD";  ///< one letter each; those of version 1.0
  bool old_ = true;                ///< version 1.x: types are Rx, Tx; a remote frame says RTR
  std::int64_t start_ = 0;         ///< us since the Unix epoch
  std::string foreign_version_;
};

}  // namespace curbstone::encoder::traces
