#pragma once

#include <string>

namespace curbstone::bench::viewer {

/// What curbstone-viewer itself takes of the vehicle's processor while a drive is mapped.
struct ViewerCpu {
  double seconds = 0;       ///< of the drive, each time
  double without_page = 0;  ///< cores
  double with_two_pages = 0;
  double frames_per_s = 0;  ///< to each of the two
  double mb_per_s = 0;      ///< to each, as sent
};

/// The log is mapped first, as fast as that goes. Then what the services would have sent in its first `seconds` is sent
/// at its pace on a bus of its own (UDP multicast, this host only) to a curbstone-viewer beside this program: once
/// without a page, once with two that read. Throws std::runtime_error if the log has no drive or the viewer does not
/// start.
[[nodiscard]] ViewerCpu measure_cpu(const std::string& log, double seconds);

}  // namespace curbstone::bench::viewer
