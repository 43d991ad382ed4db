#include "drivers/encoder/stuck_counts.hpp"

#include <fmt/format.h>

#include <cstdlib>

namespace curbstone::encoder {

namespace {
constexpr double kRevolutions = 0.1 / 60 * 1e-6;  // revolutions per us, at 0.1 rpm
}

void StuckCounts::add(std::int64_t time, const std::array<std::int32_t, 2>& counts,
                      const std::optional<Speeds>& speeds) {
  for (std::size_t i = 0; i < 2; ++i) {
    Wheel& wheel = wheels_[i];
    const bool turns = speeds && std::abs((*speeds)[i]) >= kTurning;
    if (!turns || wheel.count != counts[i] || time < wheel.last) {
      wheel = {counts[i], time, time, 0};
      continue;
    }
    wheel.missing +=
        std::abs((*speeds)[i]) * kRevolutions * static_cast<double>(time - wheel.last) * counts_per_revolution_;
    wheel.last = time;
  }
}

bool StuckCounts::stuck(std::size_t wheel) const {
  const Wheel& w = wheels_[wheel];
  return w.last - w.since >= kPatience && w.missing >= kMinCounts;
}

std::vector<std::string> StuckCounts::faults() const {
  std::vector<std::string> faults;
  for (std::size_t i = 0; i < 2; ++i) {
    if (stuck(i))
      faults.push_back(
          fmt::format("the count of the {} wheel stands still, and the drive says that it turns: encoder, "
                      "plug, or old values",
                      i == 0 ? "left" : "right"));
  }
  return faults;
}

}  // namespace curbstone::encoder
