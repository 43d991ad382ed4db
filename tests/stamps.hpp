#pragma once

#include <cstdint>

namespace curbstone::test {

inline constexpr std::int64_t kSecond = 1'000'000;             // us
inline constexpr std::int64_t kStart = 1'700'000'000'000'000;  // us: 14 November 2023, where tests of any day begin

}  // namespace curbstone::test
