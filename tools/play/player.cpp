#include "tools/play/player.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

namespace curbstone::play {

namespace {

constexpr std::int64_t kMaxAtOnce = 100'000;  // us of the caller's clock, caught up per call

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
  next_ = files_->next();
  begin_ = next_ ? next_->log_utime : 0;
  position_ = 0;
}

void Player::advance(std::int64_t now) {
  const std::int64_t passed = std::clamp<std::int64_t>(now - last_now_.value_or(now), 0, kMaxAtOnce);
  last_now_ = now;
  if (!paused_) publish_until(position_ + std::llround(static_cast<double>(passed) * speed_));
}

void Player::publish_until(std::int64_t position) {
  while (next_ && next_->log_utime - begin_ <= position) {
    if (wanted_(next_->channel)) {
      bus_.publish(next_->channel, EncodedMessage{next_->bytes});
      ++published_;
    }
    position_ = std::max(position_, next_->log_utime - begin_);
    next_ = files_->next();
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
  while (next_ && next_->log_utime - begin_ < us) {
    position_ = std::max(position_, next_->log_utime - begin_);
    next_ = files_->next();
  }
  if (next_) position_ = us;
}

}  // namespace curbstone::play
