#include "common/tile_sync/epoch_follower.hpp"

#include <fmt/format.h>

namespace curbstone {

bool EpochFollower::is_ahead(std::int32_t epoch, std::int64_t now) {
  return std::int64_t{epoch} * 1'000'000 > now + kAhead;
}

EpochFollower::Verdict EpochFollower::observe(std::int32_t epoch, Source source, std::int64_t now) {
  if (epoch_ && epoch == *epoch_) {
    strangers_ = 0;
    if (source == Source::kMapper) candidate_.reset();
    return Verdict::kPresent;
  }
  const bool plausible = !is_ahead(epoch, now);
  if (!epoch_ && plausible) return enter(epoch);

  ++strangers_;
  stranger_ = epoch;
  const bool known = candidate_ && candidate_->epoch == epoch;
  if (!known && source == Source::kMapper) candidate_ = Candidate{epoch};
  if (!candidate_ || candidate_->epoch != epoch) return Verdict::kOther;
  ++candidate_->named;
  if (source == Source::kMapper) ++candidate_->announced;

  if (plausible && epoch > *epoch_) return candidate_->named >= 2 ? enter(epoch) : Verdict::kCandidate;
  if (candidate_->announced < kFollowAfter) return Verdict::kCandidate;
  followed_at_ = now;
  return enter(epoch);
}

EpochFollower::Verdict EpochFollower::enter(std::int32_t epoch) {
  epoch_ = epoch;
  candidate_.reset();
  strangers_ = 0;
  return Verdict::kEntered;
}

std::optional<std::string> EpochFollower::fault(std::int64_t now) const {
  if (strangers_ >= kFollowAfter)
    return fmt::format("{} messages in a row are of epoch {} of the map, not of {}: is there a second mapper?",
                       strangers_, stranger_, epoch_ ? fmt::to_string(*epoch_) : "any yet");
  if (followed_at_ && now >= *followed_at_ && now - *followed_at_ < kFaultFor)
    return "the map's epoch went against the clock: the mapper's clock was set";
  return std::nullopt;
}

}  // namespace curbstone
