#pragma once

#include <string>
#include <string_view>

namespace curbstone::procman::output {

/// Converts any bytes to valid UTF-8 without zero bytes (RFC 3629); invalid bytes become U+FFFD. An LCM string ends at
/// a zero byte, and a sheriff in Java or Python may reject invalid UTF-8. An incomplete character at the end of a piece
/// is kept for the next piece.
class Utf8Stream {
 public:
  [[nodiscard]] std::string feed(std::string_view bytes);

 private:
  std::string held_;
};

}  // namespace curbstone::procman::output
