#include "services/mapper/returns/flat_intensity.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace curbstone::mapper::returns {

void FlatIntensity::check(const scan::Scan& scan) {
  if (scan.points.size() < kMinReturns) return;
  const std::uint8_t first = scan.points.front().intensity;
  const bool flat = std::ranges::all_of(scan.points, [&](const auto& point) { return point.intensity == first; });
  if (!flat) varied_ = std::min(varied_ + 1, kVaried);
  if (flat) value_ = first;
  if (verdict_.add(flat && varied_ == kVaried, scan.start)) counters_.add("faults.lidar.intensity");
}

void FlatIntensity::add_faults(std::vector<std::string>& faults) const {
  if (!verdict_.holds()) return;
  faults.push_back(
      fmt::format("LiDAR: the intensity of every return is {}, for {:.0f} s: no markings are found from there on. "
                  "Switch it off and on, check its settings, and drive that part again",
                  value_, verdict_.seconds()));
}

}  // namespace curbstone::mapper::returns
