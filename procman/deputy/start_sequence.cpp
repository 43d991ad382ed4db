#include "procman/deputy/start_sequence.hpp"

#include <algorithm>

namespace curbstone::procman::deputy {

bool StartSequence::step(std::int64_t now) {
  while (!stages_.empty()) {
    const std::vector<std::string>& stage = stages_.back();
    if (!begun_) {
      begun_ = true;
      since_ = now;
      for (auto id = stage.rbegin(); id != stage.rend(); ++id) hands_.start(*id);
    }
    // The last stage of all has nobody who waits for it.
    const bool up = stages_.size() == 1 || std::all_of(stage.begin(), stage.end(), hands_.is_up);
    if (!up && now - since_ < kPatience) return false;
    stages_.pop_back();
    begun_ = false;
  }
  return true;
}

}  // namespace curbstone::procman::deputy
