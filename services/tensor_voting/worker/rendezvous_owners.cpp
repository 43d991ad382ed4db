#include "services/tensor_voting/worker/rendezvous_owners.hpp"

#include <cstdlib>
#include <string_view>
#include <utility>

namespace curbstone::tensor_voting::worker {

namespace {

/// FNV-1a of the name, mixed with the block.
std::uint64_t rank(std::string_view worker, TileKey block) {
  std::uint64_t h = 0xcbf29ce484222325ULL;
  for (const char c : worker) h = (h ^ static_cast<unsigned char>(c)) * 0x100000001b3ULL;
  h ^= TileKeyHash{}(block);
  h = (h ^ (h >> 30)) * 0xbf58476d1ce4e5b9ULL;  // splitmix64 finaliser
  h = (h ^ (h >> 27)) * 0x94d049bb133111ebULL;
  return h ^ (h >> 31);
}

int floor_div(int a, int b) {
  return a / b - (a % b != 0 && (a < 0) != (b < 0));
}

}  // namespace

RendezvousOwners::RendezvousOwners(std::string self, std::int64_t timeout)
    : self_(std::move(self)), timeout_(timeout) {}

void RendezvousOwners::on_heartbeat(const std::string& name, std::int64_t now) {
  if (name == self_ || (last_heard_.size() >= kMaxWorkers && !last_heard_.contains(name))) return;
  last_heard_[name] = now;
}

bool RendezvousOwners::update(std::int64_t now) {
  std::erase_if(last_heard_, [&](const auto& worker) { return std::abs(now - worker.second) > timeout_; });
  std::vector<std::string> living;
  for (const auto& [name, when] : last_heard_) living.push_back(name);
  return std::exchange(others_, living) != living;
}

bool RendezvousOwners::owns(TileKey key) const {
  const TileKey block{floor_div(key.x, kTilesPerBlock), floor_div(key.y, kTilesPerBlock)};
  const std::pair mine{rank(self_, block), std::string_view(self_)};
  for (const std::string& name : others_) {
    if (std::pair{rank(name, block), std::string_view(name)} > mine) return false;
  }
  return true;
}

}  // namespace curbstone::tensor_voting::worker
