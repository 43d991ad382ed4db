#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace curbstone {

/// Reassembles messages of more than 64 kB that other programs send on the chosen channels. LCM 1.3.1 (`lcm_udpm.c`)
/// cuts them into datagrams: "LC03", sequence number, size of the whole message, offset, number of this fragment (16
/// bit), number of fragments (16 bit), all big-endian; in fragment 0 then the channel and a 0; then the bytes. A sender
/// sends one message after the other, fragment 0 first. Fragments that break these rules are refused. An incomplete
/// message is dropped when its sender begins another one, after kPatience, or when other messages need its memory.
/// Pure; one thread.
class FragmentAssembler {
 public:
  struct Limits {
    std::size_t message = std::size_t{1} << 24;  ///< bytes of one message; a larger one is refused
    std::size_t total = std::size_t{1} << 26;    ///< bytes of all incomplete messages
    std::size_t senders = 32;                    ///< senders followed at a time
  };
  static constexpr std::int64_t kPatience = 1'000'000;  ///< us without a fragment
  static constexpr std::size_t kHeader = 20;            ///< bytes of a fragment before channel or data
  static constexpr std::uint32_t kMagic = 0x4C433033;   ///< "LC03"

  struct Whole {
    std::string channel;
    std::vector<std::uint8_t> bytes;
  };

  /// `channels`: exact names.
  explicit FragmentAssembler(std::vector<std::string> channels) : FragmentAssembler(std::move(channels), Limits{}) {}
  FragmentAssembler(std::vector<std::string> channels, Limits limits)
      : channels_(std::move(channels)), limits_(limits) {}

  /// Takes a datagram that begins with kMagic. `sender`: any number unique to the sender. `now`: us of any clock.
  /// Returns the message if this fragment completes it.
  [[nodiscard]] std::optional<Whole> add(std::uint64_t sender, std::span<const std::uint8_t> datagram,
                                         std::int64_t now);

  /// Fragments that LCM does not send, and fragments of messages that are too large.
  [[nodiscard]] std::int64_t refused() const { return refused_; }
  /// Messages on the chosen channels that were begun and never completed.
  [[nodiscard]] std::int64_t dropped() const { return dropped_; }
  /// Bytes of incomplete messages.
  [[nodiscard]] std::size_t held() const { return held_; }

 private:
  struct Fragment {
    std::uint32_t sequence = 0;
    std::uint32_t size = 0;  // of the whole message
    std::uint32_t offset = 0;
    std::uint16_t number = 0;
    std::uint16_t count = 0;
    std::string channel;  // of fragment 0
    std::span<const std::uint8_t> bytes;
  };
  /// A message of which fragments 0 to `next` - 1 have arrived.
  struct Partial {
    std::uint32_t sequence = 0;
    std::uint32_t size = 0;
    std::uint16_t count = 0;
    std::uint16_t next = 0;
    std::int64_t heard = 0;  // us
    Whole whole;
  };
  using Partials = std::map<std::uint64_t, Partial>;

  [[nodiscard]] static std::optional<Fragment> read(std::span<const std::uint8_t> datagram);
  [[nodiscard]] std::optional<Whole> begin(std::uint64_t sender, const Fragment& fragment, std::int64_t now);
  [[nodiscard]] std::optional<Whole> append(Partials::iterator partial, const Fragment& fragment, std::int64_t now);
  void make_room(std::uint64_t sender, std::size_t size, std::int64_t now);
  Partials::iterator give_up(Partials::iterator partial);

  std::vector<std::string> channels_;
  Limits limits_;
  Partials partials_;  // by sender
  std::size_t held_ = 0;
  std::int64_t refused_ = 0;
  std::int64_t dropped_ = 0;
};

}  // namespace curbstone
