#include "common/bus/single_sender.hpp"

#include <algorithm>
#include <cmath>

#include "common/time/has_passed.hpp"

namespace curbstone {

namespace {

constexpr std::int64_t kSecond = 1'000'000;
constexpr double kMaxJitter = 100'000;  // us, of stamps: a serial adapter's timer, one stamp for a revolution

/// The numbers continue at 0 after 2^31 - 1.
std::int64_t step_between(std::int32_t before, std::int32_t number) {
  const auto difference = (static_cast<std::uint32_t>(number) - static_cast<std::uint32_t>(before)) & 0x7FFFFFFFU;
  return difference < 0x40000000U ? std::int64_t{difference} : std::int64_t{difference} - 0x80000000LL;
}

}  // namespace

bool SingleSender::accept(std::int64_t utime, std::int32_t number) {
  if (last_ && !is_own(utime, number)) {
    if (!has_gone(utime)) {
      ++refused_;
      return false;
    }
    *this = SingleSender(gone_);
  }
  take(utime, number);
  return true;
}

bool SingleSender::is_own(std::int64_t utime, std::int32_t number) const {
  const std::int64_t step = step_between(last_->number, number);
  const std::int64_t later = utime - last_->utime;
  if (step == 1 || (step == 0 && !numbered_)) return true;
  const double expected = static_cast<double>(step) * period_;  // us
  if (step > 1) {
    if (period_ == 0) return static_cast<double>(later) >= -kMaxJitter;
    const auto passed = static_cast<double>(later);
    return passed >= expected / 4 - kMaxJitter && passed <= 4 * expected + kSecond;
  }
  return later <= 0 && std::abs(static_cast<double>(later) - expected) <= kMaxJitter;
}

bool SingleSender::has_gone(std::int64_t utime) const {
  const std::int64_t later = utime - last_->utime;
  const auto silence = std::max(kRestart, static_cast<std::int64_t>(3 * period_));
  return (later >= silence && later <= kAbsence) || refused_ + 1 >= gone_;
}

void SingleSender::take(std::int64_t utime, std::int32_t number) {
  if (refused_ > 0) {
    others_ = has_passed(kSecond, other_, utime) ? refused_ : std::min(others_ + refused_, kMinMessages);
    other_ = utime;
    refused_ = 0;
  } else if (others_ > 0 && has_passed(kSecond, other_, utime)) {
    others_ = 0;
  }
  const std::int64_t step = last_ ? step_between(last_->number, number) : 0;
  if (last_ && step <= 0 && numbered_) return;  // late, or sent twice
  if (step == 1) numbered_ = true;
  const std::int64_t later = last_ ? utime - last_->utime : 0;
  if (later > 0 && later <= step * kSecond) {
    const double period = static_cast<double>(later) / static_cast<double>(step);
    period_ += period_ == 0 ? period : (period - period_) / 8;
  }
  last_ = Last{utime, number};
}

}  // namespace curbstone
