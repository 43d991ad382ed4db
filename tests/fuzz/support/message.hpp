#pragma once

#include <string>
#include <vector>

#include "common/bus/local_bus.hpp"
#include "tests/fuzz/support/input.hpp"

namespace curbstone::fuzz {

/// `body` as a message of this type, with the type's fingerprint before it: the fuzzer would guess it once in 2^64.
template <class Message>
[[nodiscard]] std::vector<std::uint8_t> with_fingerprint(Bytes body) {
  const auto fingerprint = static_cast<std::uint64_t>(Message::getHash());
  std::vector<std::uint8_t> bytes;
  for (int shift = 56; shift >= 0; shift -= 8) bytes.push_back(static_cast<std::uint8_t>(fingerprint >> shift));
  bytes.insert(bytes.end(), body.begin(), body.end());
  return bytes;
}

template <class Message>
void inject(LocalBus& bus, const std::string& channel, Bytes body) {
  const std::vector<std::uint8_t> bytes = with_fingerprint<Message>(body);
  bus.inject(channel, bytes.data(), static_cast<int>(bytes.size()));
}

}  // namespace curbstone::fuzz
