#include "procman/output/output_queue.hpp"

#include <algorithm>

namespace curbstone::procman::output {

namespace {

/// Length of the longest prefix of valid UTF-8 that has at most `limit` bytes and does not cut a character.
std::size_t whole_characters(std::string_view text, std::size_t limit) {
  if (text.size() <= limit) return text.size();
  while (limit > 0 && (static_cast<unsigned char>(text[limit]) & 0xC0U) == 0x80U) --limit;
  return limit;
}

}  // namespace

void OutputQueue::add(const std::string& command_id, std::string_view bytes) {
  std::string text = streams_[command_id].feed(bytes);
  if (text.empty()) return;
  if (queued_ + text.size() > kMaxQueued) {
    dropped_ += static_cast<std::int64_t>(text.size());
    dropped_unreported_ += static_cast<std::int64_t>(text.size());
    return;
  }
  queued_ += text.size();
  if (!chunks_.empty() && chunks_.back().command_id == command_id) {
    chunks_.back().text += text;
  } else {
    chunks_.push_back({command_id, std::move(text)});
  }
}

std::optional<procman_lcm::output_t> OutputQueue::take(std::int64_t utime) {
  if (chunks_.empty()) return std::nullopt;
  if (dropped_unreported_ > 0) {
    chunks_.push_front(
        {"", "[" + std::to_string(dropped_unreported_) + " bytes of output dropped: too much at once]\n"});
    queued_ += chunks_.front().text.size();
    dropped_unreported_ = 0;
  }
  procman_lcm::output_t message;
  message.utime = utime;
  message.deputy_id = deputy_id_;
  std::size_t room = kMaxMessage;
  while (!chunks_.empty() && message.command_ids.size() < 100) {
    Chunk& chunk = chunks_.front();
    const std::size_t size = whole_characters(chunk.text, room);
    if (size == 0) break;
    auto it = std::find(message.command_ids.begin(), message.command_ids.end(), chunk.command_id);
    if (it == message.command_ids.end()) {
      it = message.command_ids.insert(it, chunk.command_id);
      message.text.emplace_back();
    }
    message.text[static_cast<std::size_t>(it - message.command_ids.begin())] += chunk.text.substr(0, size);
    room -= size;
    queued_ -= size;
    if (size == chunk.text.size()) {
      chunks_.pop_front();
    } else {
      chunk.text.erase(0, size);
      break;
    }
  }
  message.num_commands = static_cast<std::int16_t>(message.command_ids.size());
  return message;
}

}  // namespace curbstone::procman::output
