#include "common/bus/socket/fragment_assembler.hpp"

#include <algorithm>

#include "common/bytes/big_endian.hpp"

namespace curbstone {

namespace {

constexpr std::size_t kMaxChannelName = 63;  // bytes

}  // namespace

std::optional<FragmentAssembler::Whole> FragmentAssembler::add(std::uint64_t sender,
                                                               std::span<const std::uint8_t> datagram,
                                                               std::int64_t now) {
  const std::optional<Fragment> fragment = read(datagram);
  if (!fragment || fragment->size > limits_.message) {
    ++refused_;
    return std::nullopt;
  }
  if (fragment->number == 0) {
    const bool is_wanted = std::find(channels_.begin(), channels_.end(), fragment->channel) != channels_.end();
    return is_wanted ? begin(sender, *fragment, now) : std::nullopt;
  }
  const auto partial = partials_.find(sender);
  if (partial == partials_.end() || partial->second.sequence != fragment->sequence) return std::nullopt;
  return append(partial, *fragment, now);
}

std::optional<FragmentAssembler::Fragment> FragmentAssembler::read(std::span<const std::uint8_t> datagram) {
  if (datagram.size() <= kHeader || read_big_endian<std::uint32_t>(datagram) != kMagic) return std::nullopt;
  Fragment fragment{.sequence = read_big_endian<std::uint32_t>(datagram.subspan(4)),
                    .size = read_big_endian<std::uint32_t>(datagram.subspan(8)),
                    .offset = read_big_endian<std::uint32_t>(datagram.subspan(12)),
                    .number = read_big_endian<std::uint16_t>(datagram.subspan(16)),
                    .count = read_big_endian<std::uint16_t>(datagram.subspan(18)),
                    .channel = {},
                    .bytes = datagram.subspan(kHeader)};
  if (fragment.number >= fragment.count) return std::nullopt;
  if (fragment.number == 0) {
    const auto end = std::find(fragment.bytes.begin(), fragment.bytes.end(), 0);
    const auto length = static_cast<std::size_t>(end - fragment.bytes.begin());
    if (end == fragment.bytes.end() || length == 0 || length > kMaxChannelName || fragment.offset != 0)
      return std::nullopt;
    fragment.channel.assign(fragment.bytes.begin(), end);
    fragment.bytes = fragment.bytes.subspan(length + 1);
  }
  if (fragment.offset > fragment.size || fragment.bytes.size() > fragment.size - fragment.offset) return std::nullopt;
  return fragment;
}

std::optional<FragmentAssembler::Whole> FragmentAssembler::begin(std::uint64_t sender, const Fragment& fragment,
                                                                 std::int64_t now) {
  if (const auto before = partials_.find(sender); before != partials_.end()) give_up(before);
  make_room(sender, fragment.size, now);
  Partial partial{.sequence = fragment.sequence, .size = fragment.size, .count = fragment.count, .whole = {}};
  partial.whole.channel = fragment.channel;
  held_ += fragment.size;
  return append(partials_.emplace(sender, std::move(partial)).first, fragment, now);
}

/// Fragments must come in order: after a gap, no further fragment can complete the message.
std::optional<FragmentAssembler::Whole> FragmentAssembler::append(Partials::iterator partial, const Fragment& fragment,
                                                                  std::int64_t now) {
  Partial& message = partial->second;
  std::vector<std::uint8_t>& bytes = message.whole.bytes;
  if (fragment.number < message.next) return std::nullopt;  // a duplicate
  const bool follows = fragment.number == message.next && fragment.offset == bytes.size() &&
                       fragment.size == message.size && fragment.count == message.count;
  const bool is_last = fragment.number + 1 == message.count;
  if (!follows || is_last != (bytes.size() + fragment.bytes.size() == message.size)) {
    give_up(partial);
    return std::nullopt;
  }
  bytes.insert(bytes.end(), fragment.bytes.begin(), fragment.bytes.end());
  ++message.next;
  message.heard = now;
  if (!is_last) return std::nullopt;
  Whole whole = std::move(message.whole);
  held_ -= message.size;
  partials_.erase(partial);
  return whole;
}

void FragmentAssembler::make_room(std::uint64_t sender, std::size_t size, std::int64_t now) {
  for (auto it = partials_.begin(); it != partials_.end();) {
    const bool is_old = now - it->second.heard > kPatience || now < it->second.heard;
    it = is_old && it->first != sender ? give_up(it) : std::next(it);
  }
  while (!partials_.empty() && (partials_.size() >= limits_.senders || held_ + size > limits_.total)) {
    give_up(std::min_element(partials_.begin(), partials_.end(),
                             [](const auto& a, const auto& b) { return a.second.heard < b.second.heard; }));
  }
}

FragmentAssembler::Partials::iterator FragmentAssembler::give_up(Partials::iterator partial) {
  ++dropped_;
  held_ -= partial->second.size;
  return partials_.erase(partial);
}

}  // namespace curbstone
