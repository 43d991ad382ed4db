#pragma once

#include <cstdint>
#include <cstdlib>
#include <optional>

namespace curbstone::ekf::inputs {

/// Checks the stamps of one channel: they must increase, by no more than `max_jump` at a time. A single wild stamp is a
/// bad message; kConfirmations wild stamps that agree with each other mean that the clock has jumped (or that the
/// sensor was silent for long), and are accepted.
class StampGuard {
 public:
  enum class Verdict {
    kGood,
    kDuplicate,
    kBackwards,   ///< older than the stamp before
    kSuspicious,  ///< far off; refused unless the next ones agree
    kJumped,      ///< accepted: the clock has jumped to it
  };

  explicit StampGuard(std::int64_t max_jump_us) : max_jump_(max_jump_us) {}

  [[nodiscard]] Verdict judge(std::int64_t utime) {
    if (!last_) {
      last_ = utime;
      return Verdict::kGood;
    }
    const std::int64_t step = utime - *last_;
    if (std::abs(step) <= max_jump_) {
      candidate_.reset();
      if (step == 0) return Verdict::kDuplicate;
      if (step < 0) return Verdict::kBackwards;
      last_ = utime;
      return Verdict::kGood;
    }
    const bool agrees = candidate_ && utime > *candidate_ && utime - *candidate_ <= max_jump_;
    agreeing_ = agrees ? agreeing_ + 1 : 1;
    candidate_ = utime;
    if (agreeing_ < kConfirmations) return Verdict::kSuspicious;
    candidate_.reset();
    last_ = utime;
    return Verdict::kJumped;
  }
  void reset() {
    last_.reset();
    candidate_.reset();
  }

 private:
  static constexpr int kConfirmations = 3;
  std::int64_t max_jump_;
  std::optional<std::int64_t> last_;
  std::optional<std::int64_t> candidate_;
  int agreeing_ = 0;
};

}  // namespace curbstone::ekf::inputs
