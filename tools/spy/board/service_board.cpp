#include "tools/spy/board/service_board.hpp"

#include <algorithm>
#include <initializer_list>
#include <string_view>

namespace curbstone::spy::board {

namespace {

std::int64_t sum_of(const service_status_t& status, std::initializer_list<std::string_view> beginnings) {
  std::int64_t sum = 0;
  for (std::size_t k = 0; k < status.counter_name.size(); ++k) {
    const std::string& name = status.counter_name[k];
    if (std::ranges::any_of(beginnings, [&](std::string_view begin) { return name.starts_with(begin); }))
      sum += status.counter_value[k];
  }
  return sum;
}

/// Per second; the counts of a restarted process start again, which gives 0.
double per_second(std::int64_t before, std::int64_t after, double seconds) {
  return static_cast<double>(std::max<std::int64_t>(after - before, 0)) / seconds;
}

}  // namespace

std::optional<std::int64_t> ServiceState::counter(const std::string& name) const {
  const auto found = std::ranges::find(status.counter_name, name);
  if (found == status.counter_name.end()) return std::nullopt;
  return status.counter_value[static_cast<std::size_t>(found - status.counter_name.begin())];
}

void ServiceBoard::add(const service_status_t& status, std::int64_t now) {
  const std::pair key(status.service, status.host);
  if (!services_.contains(key) && services_.size() >= kMaxServices) return;
  ServiceState& state = services_[key];
  const double seconds = static_cast<double>(status.uptime - state.status.uptime) * 1e-6;
  if (state.heard != 0 && state.status.pid == status.pid && seconds > 0) {
    state.cpu = per_second(state.status.cpu_time, status.cpu_time, seconds) * 1e-6;
    state.dropped =
        per_second(sum_of(state.status, {"dropped.", "lost."}), sum_of(status, {"dropped.", "lost."}), seconds);
    state.refused = per_second(sum_of(state.status, {"refused."}), sum_of(status, {"refused."}), seconds);
  }
  state.status = status;
  state.heard = now;
  state.clock = status.utime - now;
}

}  // namespace curbstone::spy::board
