#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace curbstone {

/// Decides which epoch of the map a listener follows. When an epoch ends, everything made in it becomes void, so one
/// damaged or foreign message must not begin another one. The mapper names an epoch after the second in which it
/// begins, and only the mapper begins one:
///
/// - The first epoch heard is entered at once, unless it lies more than a minute ahead.
/// - A newer epoch is entered at the second message that names it, of which one must be the mapper's own announcement.
///   Until then it is a candidate; an announcement of the present epoch discards the candidate.
/// - An epoch that is older, or more than a minute ahead, is entered when the mapper has named it kFollowAfter times in
///   a row: the mapper's clock was set, or it continues an earlier map.
///
/// Pure: message time in, one thread.
class EpochFollower {
 public:
  enum class Source {
    kMapper,  ///< the mapper's own announcement: MAP_POSE, MAP_TRAJECTORY, TILE_INDEX of its tiles
    kOther,   ///< a process that names an epoch it has heard of
  };
  enum class Verdict {
    kPresent,    ///< of the present epoch
    kEntered,    ///< of an epoch that begins with this message: data of the previous epoch is void
    kCandidate,  ///< of an epoch that may begin with one of the next messages
    kOther,      ///< of an epoch that is over, or that only this message names
  };

  static constexpr int kFollowAfter = 50;                ///< announcements: 2.5 s of MAP_POSE
  static constexpr std::int64_t kAhead = 60'000'000;     ///< us
  static constexpr std::int64_t kFaultFor = 10'000'000;  ///< us

  /// A message names `epoch` at `now`, us of message time.
  Verdict observe(std::int32_t epoch, Source source, std::int64_t now);

  [[nodiscard]] std::optional<std::int32_t> epoch() const { return epoch_; }
  /// A fault in words if candidates or strangers persist: kFollowAfter messages in a row that are not of the present
  /// epoch, or an epoch entered within the last ten seconds although it contradicts the clock.
  [[nodiscard]] std::optional<std::string> fault(std::int64_t now) const;

 private:
  Verdict enter(std::int32_t epoch);
  [[nodiscard]] static bool is_ahead(std::int32_t epoch, std::int64_t now);

  struct Candidate {
    std::int32_t epoch = 0;
    int named = 0;      // by any process
    int announced = 0;  // by the mapper
  };
  std::optional<std::int32_t> epoch_;
  std::optional<Candidate> candidate_;
  int strangers_ = 0;  // messages in a row that are not of the present epoch
  std::int32_t stranger_ = 0;
  std::optional<std::int64_t> followed_at_;
};

}  // namespace curbstone
