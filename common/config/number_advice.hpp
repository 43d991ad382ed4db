#pragma once

#include <optional>
#include <string>

namespace curbstone {

/// What to write instead of a text that is no number: ": write 0.2" for "0,2", ": only a number, without a unit" for
/// "0.2 m". Empty if nothing is known.
[[nodiscard]] std::string number_advice(const std::string& text);

/// "010" without its leading zeros, by which yaml-cpp takes it for octal. Empty if it has none.
[[nodiscard]] std::optional<std::string> without_leading_zeros(const std::string& text);

}  // namespace curbstone
