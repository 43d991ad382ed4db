#include "common/resend/message_keeper.hpp"

#include <algorithm>
#include <cstring>
#include <utility>

namespace curbstone {

int MessageKeeper::Encoded::encode(void* to, int offset, int max) const {
  if (offset < 0 || max < getEncodedSize()) return -1;
  std::memcpy(static_cast<std::uint8_t*>(to) + offset, bytes.data(), bytes.size());
  return getEncodedSize();
}

bool MessageKeeper::make_room(std::int64_t utime, std::size_t size) {
  if (utime <= 0 || size > limits_.bytes) return false;
  if (!kept_.empty() && utime <= kept_.back().utime) {
    if (kept_.back().utime - utime < limits_.span) return false;
    kept_.clear();  // the clock was set back
    kept_bytes_ = 0;
  }
  while (!kept_.empty() && (kept_bytes_ + size > limits_.bytes || utime - kept_.front().utime > limits_.span))
    forget_oldest();
  return true;
}

void MessageKeeper::forget_oldest() {
  kept_bytes_ -= kept_.front().bytes.size();
  spare_ = std::move(kept_.front().bytes);
  kept_.pop_front();
}

void MessageKeeper::add(Encoded message) {
  kept_bytes_ += message.bytes.size();
  kept_.push_back(std::move(message));
}

void MessageKeeper::request(const resend_request_t& message) {
  if (message.channel != channel_) return;
  std::erase_if(wanted_, [&](const Wanted& wanted) { return wanted.requester == message.requester; });
  if (message.after >= message.before || wanted_.size() >= kMostAsking) return;
  wanted_.push_back({message.requester, message.after, message.before});
  send();
}

void MessageKeeper::tick() {
  messages_left_ = kAtOnce;
  bytes_left_ = kBytesAtOnce;
  send();
}

/// In turn: one message to each who asks.
void MessageKeeper::send() {
  while (!wanted_.empty()) {
    Wanted wanted = std::move(wanted_.front());
    const auto next = std::upper_bound(kept_.begin(), kept_.end(), wanted.after,
                                       [](std::int64_t after, const Encoded& kept) { return after < kept.utime; });
    if (next == kept_.end() || next->utime >= wanted.before) {
      wanted_.pop_front();
      continue;
    }
    if (messages_left_ == 0 || (next->bytes.size() > bytes_left_ && messages_left_ < kAtOnce)) {
      wanted_.front() = std::move(wanted);
      return;
    }
    wanted_.pop_front();
    bus_.publish(again(channel_), *next);
    ++resent_;
    --messages_left_;
    bytes_left_ -= std::min(bytes_left_, next->bytes.size());
    wanted.after = next->utime;
    wanted_.push_back(std::move(wanted));
  }
}

}  // namespace curbstone
