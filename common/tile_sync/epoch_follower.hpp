#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace curbstone {

/// Which epoch of the map a listener believes in. An epoch that is over takes everything with it that was made in it.
/// So one damaged or foreign message must not begin another one. The mapper names an epoch after the second in which it
/// begins, and only the mapper begins one:
///
/// - The first epoch that is heard of is entered at once, unless it lies more than a minute ahead.
/// - A newer one is entered at the second message that names it, of which one must be the mapper's own announcement.
///   Until then it is a candidate; an announcement of the present epoch ends that.
/// - One that is older, or more than a minute ahead, is entered when the mapper has named it kFollowAfter times in a
///   row: its clock was set, or it goes on with a map of before that.
///
/// Pure: message time in, one thread.
class EpochFollower {
 public:
  enum class Source {
    kMapper,  ///< the mapper's own announcement: MAP_POSE, MAP_TRAJECTORY, TILE_INDEX of its tiles
    kOther,   ///< names an epoch that it has heard of itself
  };
  enum class Verdict {
    kPresent,    ///< of the present epoch
    kEntered,    ///< of an epoch that begins with this message: what belongs to the one before is void
    kCandidate,  ///< of one that may begin with one of the next messages
    kOther,      ///< of an epoch that is over, or that nobody but this message speaks of
  };

  static constexpr int kFollowAfter = 50;                ///< announcements: 2.5 s of MAP_POSE
  static constexpr std::int64_t kAhead = 60'000'000;     ///< us
  static constexpr std::int64_t kFaultFor = 10'000'000;  ///< us

  /// A message names `epoch` at `now`, us of message time.
  Verdict hear(std::int32_t epoch, Source source, std::int64_t now);

  [[nodiscard]] std::optional<std::int32_t> epoch() const { return epoch_; }
  /// Where candidates or strangers persist: kFollowAfter messages in a row that are not of the present epoch, or an
  /// epoch that was entered against the clock within the last ten seconds.
  [[nodiscard]] std::optional<std::string> fault(std::int64_t now) const;

 private:
  Verdict enter(std::int32_t epoch);
  [[nodiscard]] static bool is_ahead(std::int32_t epoch, std::int64_t now);

  struct Candidate {
    std::int32_t epoch = 0;
    int named = 0;      // by anybody
    int announced = 0;  // by the mapper
  };
  std::optional<std::int32_t> epoch_;
  std::optional<Candidate> candidate_;
  int strangers_ = 0;  // messages in a row that are not of the present epoch
  std::int32_t stranger_ = 0;
  std::optional<std::int64_t> followed_at_;
};

}  // namespace curbstone
