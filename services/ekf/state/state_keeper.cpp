#include "services/ekf/state/state_keeper.hpp"

#include <utility>

#include "services/ekf/state/state_file.hpp"

namespace curbstone::ekf::state {

StateKeeper::StateKeeper(std::string path)
    : path_(std::move(path)), thread_([this](const std::stop_token& stop) { write(stop); }) {}

StateKeeper::~StateKeeper() = default;

void StateKeeper::keep(const model::Belief& belief) {
  {
    const std::lock_guard lock(mutex_);
    newest_ = belief;
  }
  wake_.notify_one();
}

void StateKeeper::write(const std::stop_token& stop) {
  for (;;) {
    std::optional<model::Belief> belief;
    {
      std::unique_lock lock(mutex_);
      wake_.wait(lock, stop, [this] { return newest_.has_value(); });
      belief = std::exchange(newest_, std::nullopt);
    }
    if (!belief) return;  // asked to stop, and nothing is left to write
    failing_ = !save_state(path_, *belief);
    if (failing_) ++failures_;
  }
}

}  // namespace curbstone::ekf::state
