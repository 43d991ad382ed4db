#pragma once

#include <string>
#include <string_view>

namespace curbstone::procman {

/// Makes valid UTF-8 without zero bytes of whatever a process prints: what is not becomes U+FFFD. An LCM string ends at
/// a zero byte, and a sheriff in Java or Python may refuse bad UTF-8. A character cut by a read is held for the next
/// one.
class Utf8Stream {
 public:
  [[nodiscard]] std::string feed(std::string_view bytes);

 private:
  std::string held_;
};

}  // namespace curbstone::procman
