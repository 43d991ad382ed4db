#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <random>
#include <utility>
#include <vector>

namespace curbstone::test {

/// What happened to a packet on its way.
enum class Fate { kGood, kCorrupt, kCut, kDoubled, kSwapped };
inline constexpr std::array kFates = {"good", "corrupt", "cut", "doubled", "swapped"};

/// Leaves a packet's first part.
inline void cut(std::vector<std::uint8_t>& packet, std::mt19937& random) {
  packet.resize(random() % packet.size());
}

/// A way that corrupts, cuts, doubles and swaps with its follower one packet in a hundred each.
template <class Packet>
class Damage {
 public:
  struct Kinds {
    std::function<void(Packet&, std::mt19937&)> corrupt;
    std::function<void(Packet&, std::mt19937&)> cut;
  };
  using Deliver = std::function<void(const Packet&)>;

  Damage(unsigned seed, Kinds kinds) : random_(seed), kinds_(std::move(kinds)) {}

  /// What is to become of the next packet; `spare`: nothing.
  Fate draw(bool spare) {
    const auto draw = spare || held_ ? 100 : random_() % 100;  // the follower of a swapped one has had its share
    return draw < 4 ? static_cast<Fate>(1 + draw) : Fate::kGood;
  }
  /// Makes it so: `deliver` gets what arrives now.
  void pass(Packet packet, Fate fate, const Deliver& deliver) {
    if (fate == Fate::kCorrupt) kinds_.corrupt(packet, random_);
    if (fate == Fate::kCut) kinds_.cut(packet, random_);
    if (fate == Fate::kSwapped) {
      held_ = std::move(packet);
      return;
    }
    deliver(packet);
    if (fate == Fate::kDoubled) deliver(packet);
    release(deliver);
  }
  /// The one that waits for its follower comes before it all the same.
  void release(const Deliver& deliver) {
    if (const auto held = std::exchange(held_, std::nullopt)) deliver(*held);
  }

 private:
  std::mt19937 random_;
  Kinds kinds_;
  std::optional<Packet> held_;
};

}  // namespace curbstone::test
