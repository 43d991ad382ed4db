#include "tools/play/player.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

namespace curbstone::play {

namespace {

constexpr std::int64_t kMaxAtOnce = 100'000;                 // us of the caller's clock, caught up per call
constexpr std::int64_t kMaxSilence = 10'000'000;             // us
constexpr std::int64_t kCentury = 100 * 31'557'600'000'000;  // us: no clock is set by so much
constexpr std::int64_t kMaxLate = 10'000'000;  // us; a log of `replay` has its records in the order of computation

/// us; a damaged record may have any time.
std::int64_t time_of(const LogEvent& event) {
  return std::clamp<std::int64_t>(event.log_utime, 0, std::int64_t{1} << 60);
}

/// Wraps encoded bytes as a message, for Publisher.
struct EncodedMessage {
  const std::vector<std::uint8_t>& bytes;
  [[nodiscard]] int getEncodedSize() const { return static_cast<int>(bytes.size()); }
  int encode(void* out, int offset, int size) const {
    if (size < getEncodedSize()) return -1;
    std::memcpy(static_cast<std::uint8_t*>(out) + offset, bytes.data(), bytes.size());
    return getEncodedSize();
  }
};

}  // namespace

Player::Player(std::vector<std::string> logs, Publisher& bus, Wanted wanted)
    : logs_(std::move(logs)), bus_(bus), wanted_(std::move(wanted)) {
  open();
}

void Player::open() {
  files_ = std::make_unique<LogFiles>(logs_);
  next_at_ = set_back_ = position_ = 0;
  next_ = files_->next();
  begin_ = next_ ? time_of(*next_) : 0;
}

void Player::read_next() {
  const std::int64_t last = next_at_;
  next_ = files_->next();
  if (!next_) return;
  next_at_ = time_of(*next_) - begin_ + set_back_;
  if (next_at_ >= last - kMaxLate && next_at_ <= last + kCentury) return;
  set_back_ += last - next_at_;
  next_at_ = last;
}

void Player::advance(std::int64_t now) {
  const std::int64_t passed = std::clamp<std::int64_t>(now - last_now_.value_or(now), 0, kMaxAtOnce);
  last_now_ = now;
  if (paused_) return;
  publish_until(position_ + std::llround(static_cast<double>(passed) * speed_));
  if (next_ && next_at_ - position_ > kMaxSilence) position_ = next_at_;
}

void Player::publish_until(std::int64_t position) {
  while (next_ && next_at_ <= position) {
    if (wanted_(next_->channel)) {
      bus_.publish(next_->channel, EncodedMessage{next_->bytes});
      ++published_;
    }
    position_ = std::max(position_, next_at_);
    read_next();
  }
  if (next_) position_ = position;  // at the end the position stays
}

void Player::set_speed(double speed) {
  speed_ = std::clamp(speed, 0.01, 100.0);
}

void Player::step(std::int64_t us) {
  paused_ = true;
  publish_until(position_ + us);
}

void Player::seek(std::int64_t us) {
  us = std::max<std::int64_t>(us, 0);
  if (us < position_) open();
  while (next_ && next_at_ < us) {
    position_ = std::max(position_, next_at_);
    read_next();
  }
  if (next_) position_ = us;
}

}  // namespace curbstone::play
