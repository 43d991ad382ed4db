#include "services/mapper/start_hold.hpp"

#include <cstddef>
#include <utility>

#include "services/mapper/scan/scan.hpp"

namespace curbstone::mapper {
namespace {

constexpr std::size_t kMostHeld = 20;  // scans: more show nothing new

}  // namespace

std::vector<StartHold::Insertion> StartHold::admit(Insertion next, const Standstill& standstill) {
  if (standstill.has_moved) held_.clear();
  if (!standstill.has_moved && scan::seconds(standstill.began, next.utime) <= seconds_) {
    next.add_new = true;
    if (held_.size() < kMostHeld) held_.push_back(std::move(next));
    return {};
  }
  std::vector<Insertion> admitted = release();
  admitted.push_back(std::move(next));
  return admitted;
}

std::vector<StartHold::Insertion> StartHold::release() {
  return std::exchange(held_, {});
}

}  // namespace curbstone::mapper
