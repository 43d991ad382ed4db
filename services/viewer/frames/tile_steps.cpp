#include "services/viewer/frames/tile_steps.hpp"

#include <algorithm>

#include "services/viewer/frames/tile_records.hpp"

namespace curbstone::viewer::frames {

void TileSteps::will_change(TileKey key, const store::TileCells* before) {
  if (before_.contains(key)) return;
  before_.emplace(key, before == nullptr ? std::nullopt : std::optional(*before));
}

void TileSteps::close(const store::LiveMap& map) {
  if (map.number() == number_) return;
  ByteWriter records;
  for (const auto& [key, before] : before_) {
    const store::TileCells* cells = map.at(key);
    if (cells == nullptr) continue;
    if (before)
      write_changes(records, key, *before, *cells);
    else
      write_tile(records, key, *cells);
  }
  before_.clear();
  bytes_ += records.size();
  steps_.push_back({number_, map.number(), records.take()});
  number_ = map.number();
  while (steps_.size() > kMaxSteps || bytes_ > kMaxBytes) {
    bytes_ -= steps_.front().records.size();
    steps_.pop_front();
  }
}

void TileSteps::clear(const store::LiveMap& map) {
  before_.clear();
  steps_.clear();
  bytes_ = 0;
  number_ = map.number();
}

std::optional<std::vector<const TileSteps::Step*>> TileSteps::from(std::uint64_t number) const {
  std::vector<const Step*> way;
  if (number == number_) return way;
  for (const Step& step : steps_) {
    if (step.from >= number) way.push_back(&step);
  }
  if (way.empty() || way.front()->from != number) return std::nullopt;
  return way;
}

}  // namespace curbstone::viewer::frames
