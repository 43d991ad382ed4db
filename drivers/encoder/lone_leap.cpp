#include "drivers/encoder/lone_leap.hpp"

#include <algorithm>
#include <cmath>

namespace curbstone::encoder {

namespace {
constexpr double kMemory = 16;  // samples
}

bool LoneLeap::refuses(const Pair& error, double tolerance) {
  bool alone = false;
  for (std::size_t i = 0; i < 2; ++i) {
    const double size = std::abs(error[i]);
    const double limit = std::max(tolerance, kTimes * usual_[i]);
    usual_[i] += (std::min(size, limit / 2) - usual_[i]) / kMemory;  // damage is not usual
    const bool stays = leap_ && (*leap_)[i] * error[i] > 0 && 2 * size >= std::abs((*leap_)[i]);
    alone = alone || (size > limit && !stays);
  }
  if (!alone || refused_ == kMost) {
    leap_.reset();
    refused_ = 0;
    return false;
  }
  leap_ = error;
  ++refused_;
  return true;
}

}  // namespace curbstone::encoder
