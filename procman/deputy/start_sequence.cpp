#include "procman/deputy/start_sequence.hpp"

#include <algorithm>

namespace curbstone::procman::deputy {

void StartSequence::start(const std::vector<std::string>& stage) {
  for (auto id = stage.rbegin(); id != stage.rend(); ++id) callbacks_.start(*id);
}

bool StartSequence::step(std::int64_t now) {
  if (stages_.empty()) return true;
  const auto sources = stages_.begin();
  if (!begun_) {
    begun_ = true;
    since_ = now;
    for (auto stage = std::prev(stages_.end()); stage != sources; --stage) start(*stage);
  }
  const bool up = std::all_of(std::next(sources), stages_.end(), [this](const auto& stage) {
    return std::all_of(stage.begin(), stage.end(), callbacks_.is_up);
  });
  if (!up && now - since_ < kPatience) return false;
  start(*sources);
  stages_.clear();
  return true;
}

}  // namespace curbstone::procman::deputy
