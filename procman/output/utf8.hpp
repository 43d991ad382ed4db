#pragma once

#include <string>
#include <string_view>

namespace curbstone::procman::output {

/// Turns any bytes into valid UTF-8 without zero bytes (RFC 3629); what is invalid becomes U+FFFD. An LCM string ends
/// at a zero byte, and a sheriff in Java or Python may refuse bad UTF-8. The beginning of a character at the end of a
/// piece is kept for the next piece.
class Utf8Stream {
 public:
  [[nodiscard]] std::string feed(std::string_view bytes);

 private:
  std::string held_;
};

}  // namespace curbstone::procman::output
