#include "drivers/lidar/decoding/blind_zone.hpp"

#include <cmath>
#include <cstdlib>

namespace curbstone::lidar::decoding {

namespace {

constexpr int kFullTurn = 36000;
constexpr int kTolerance = 200;  // 0.01 deg: two blocks and the device's rounding

bool same(const Gap& a, const Gap& b) {
  const int apart = std::abs(a.from - b.from) % kFullTurn;
  return std::min(apart, kFullTurn - apart) <= kTolerance && std::abs(a.width - b.width) <= kTolerance;
}

}  // namespace

void BlindZone::set_field_of_view(int start, int end) {
  reported_.reset();
  const int fires = ((end - start) % kFullTurn + kFullTurn) % kFullTurn;
  if (fires != 0) reported_ = Gap{end % kFullTurn, kFullTurn - fires};
}

bool BlindZone::is(const Gap& gap) const {
  return (reported_ && same(*reported_, gap)) || (learnt_ && same(*learnt_, gap));
}

void BlindZone::suspect(const Gap& gap, std::int64_t stamp, double without, double with) {
  suspect_ = Suspect{gap, stamp, without, with};
}

void BlindZone::next_stamp(std::int64_t stamp) {
  if (!suspect_) return;
  const auto passed = static_cast<double>(stamp - suspect_->stamp);
  const bool waited = std::abs(passed - suspect_->with) < 0.1 * (suspect_->with - suspect_->without);
  if (waited && seen_once_ && same(*seen_once_, suspect_->gap)) learnt_ = suspect_->gap;
  if (waited) seen_once_ = suspect_->gap;
  suspect_.reset();
}

}  // namespace curbstone::lidar::decoding
