#pragma once

#include <cstdint>

namespace curbstone {

/// A lost vehicle maps nothing, and the mapper may begin a new drive with another map. Therefore each stage then
/// computes and publishes what it would otherwise leave to the end of the drive, unless that is too much. A value,
/// pure.
class LostTimer {
 public:
  // us of being lost, in the order of the stages; the mapper begins a new drive after 12 s at the earliest.
  static constexpr std::int64_t kMapper = 6'000'000;
  static constexpr std::int64_t kVoters = 8'000'000;
  static constexpr std::int64_t kSemanticMap = 10'000'000;

  /// `after`: one of these.
  explicit LostTimer(std::int64_t after) : after_(after) {}

  /// Takes a MAP_POSE: its time, us, and whether it is LOST.
  void on_pose(std::int64_t utime, bool is_lost) {
    if (!is_lost) return clear();
    if (since_ == 0) since_ = utime;
    newest_ = utime;
  }
  /// Another epoch begins.
  void clear() {
    since_ = newest_ = 0;
    is_used_ = false;
  }
  /// True once in each time that the vehicle is lost, when that has lasted for long enough.
  [[nodiscard]] bool take() {
    if (is_used_ || since_ == 0 || newest_ - since_ < after_) return false;
    is_used_ = true;
    return true;
  }

 private:
  std::int64_t after_;
  std::int64_t since_ = 0;  // us; 0: the vehicle is not lost
  std::int64_t newest_ = 0;
  bool is_used_ = false;
};

}  // namespace curbstone
