#pragma once

#include <cstdint>
#include <string>

namespace curbstone {

/// A path that does not exist yet, for what must make room for something new: `stem`, the UTC of `utime` (us), and
/// `extension`: map-20261123T165133Z.db. If that is taken, by a vehicle whose clock begins anew at each start, -2, -3
/// ... follows the time.
[[nodiscard]] std::string free_dated_path(const std::string& stem, std::int64_t utime,
                                          const std::string& extension = "");

}  // namespace curbstone
