#include "tools/replay/vehicle_line.hpp"

#include <array>
#include <cstdlib>
#include <utility>

namespace curbstone::replay {

namespace {

constexpr std::int64_t kBeat = 250'000;        // us; the mapper publishes its changes once per beat
constexpr int kMapperBeats = 1;                // between two ticks
constexpr int kOtherBeats = 8;                 // likewise; rare, so that each tile is computed once (at 3 s a voting
                                               // worker takes the mapper for silent)
constexpr std::int64_t kMaxGap = 50;           // beats; longer gaps in the log are not ticked through
constexpr std::int64_t kMaxMessages = 20'000;  // per beat; for a log whose time stands still

enum Group : std::size_t { kMapping, kVoting, kSemantics, kNumGroups };

Group group_of(const std::string& stage) {
  if (stage == "tensor_voting") return kVoting;
  return stage == "semantic_map" ? kSemantics : kMapping;
}

std::vector<std::unique_ptr<StageGroup>> make_groups() {
  std::vector<std::unique_ptr<StageGroup>> groups;
  for (const int beats : std::array<int, kNumGroups>{kMapperBeats, kOtherBeats, kOtherBeats})
    groups.push_back(std::make_unique<StageGroup>(beats));
  return groups;
}

}  // namespace

VehicleLine::VehicleLine(const ReplayOptions& options, StageLine::Options line)
    : groups_(make_groups()),
      stages_(
          make_stages(options, [&](const std::string& name) -> Publisher& { return groups_[group_of(name)]->bus(); })) {
  for (const Stage& stage : stages_) groups_[group_of(stage.name)]->add(*stage.node);
  line_ = std::make_unique<StageLine>(std::move(groups_), std::move(line));
}

void VehicleLine::deliver(std::int64_t now, std::string channel, std::vector<std::uint8_t> bytes) {
  advance(now);
  line_->deliver(std::move(channel), std::move(bytes));
}

void VehicleLine::note(std::string channel, std::vector<std::uint8_t> bytes) {
  line_->deliver(std::move(channel), std::move(bytes));
}

void VehicleLine::advance(std::int64_t now) {
  if (last_beat_ == 0) last_beat_ = now;
  if (std::abs(now - last_beat_) > kMaxGap * kBeat) last_beat_ = now - kBeat;
  if (++messages_ > kMaxMessages) {
    messages_ = 0;
    line_->beat(last_beat_, false);
  }
  while (last_beat_ + kBeat <= now) {
    messages_ = 0;
    line_->beat(last_beat_ += kBeat, true);
  }
}

void VehicleLine::finish() {
  line_->end_drive();
  if (last_beat_ != 0) settle();  // else there was no drive
  line_->finish();
}

/// A loop closed near the end of the drive has the whole map sent again, and points may still be requested.
void VehicleLine::settle() {
  Settling settling;
  do {
    for (std::int64_t beat = 0; beat < Settling::kRound / kBeat; ++beat) line_->beat(last_beat_ += kBeat, true);
    line_->wait();
  } while (settling.goes_on(stages_, last_beat_));
}

}  // namespace curbstone::replay
