#include "tools/bench/sensor_faults/witness.hpp"

#include <algorithm>

#include "common/bus/harmless_counters.hpp"
#include "common/shell/fault_lines.hpp"

namespace curbstone::bench::sensor_faults {

namespace {

constexpr double kApart = 2.0;  // s, by which a fault may be reported longer than in the undisturbed drive

bool is_loss(const std::string& counter) {
  const bool loss = counter.starts_with("dropped.") || counter.starts_with("refused.") || counter.starts_with("lost.");
  return loss && !is_harmless(counter);
}

std::vector<Said> sorted(std::vector<Said> said) {
  std::ranges::stable_sort(said, {}, &Said::at);
  return said;
}

}  // namespace

void Witness::look(double t, const std::vector<replay::Stage>& stages) {
  for (const replay::Stage& stage : stages) {
    const NodeReport report = stage.node->report();
    for (const std::string& fault : report.faults) {
      Noted& noted = faults_[{stage.name, without_numbers(fault)}];
      if (noted.seen.empty()) noted.said = {stage.name, fault, t, t};
      noted.said.last = t;
      noted.seen.emplace_back(t, 0);
    }
    for (const auto& [name, value] : report.counters.values()) {
      if (value == 0 || !is_loss(name)) continue;
      Noted& noted = counters_[{stage.name, name}];
      if (noted.seen.empty()) noted.said = {stage.name, name, t, t};
      if (noted.said.value == value) continue;
      noted.said.last = t;
      noted.said.value = value;
      noted.seen.emplace_back(t, value);
    }
  }
}

std::vector<Said> Witness::new_faults(const Witness& undisturbed, double from) const {
  std::vector<Said> said;
  for (const auto& [key, noted] : faults_) {
    const auto known = undisturbed.faults_.find(key);
    const double since = known == undisturbed.faults_.end() ? from : std::max(from, known->second.said.last + kApart);
    const auto first = std::ranges::find_if(noted.seen, [&](const auto& seen) { return seen.first >= since; });
    if (first == noted.seen.end()) continue;
    said.push_back(noted.said);
    said.back().at = first->first;
  }
  return sorted(std::move(said));
}

std::vector<Said> Witness::new_counters(const Witness& undisturbed, double from) const {
  std::vector<Said> said;
  for (const auto& [key, noted] : counters_) {
    const auto known = undisturbed.counters_.find(key);
    const std::int64_t usual = known == undisturbed.counters_.end() ? 0 : known->second.said.value;
    const auto first =
        std::ranges::find_if(noted.seen, [&](const auto& seen) { return seen.first >= from && seen.second > usual; });
    if (first == noted.seen.end()) continue;
    said.push_back(noted.said);
    said.back().at = first->first;
  }
  return sorted(std::move(said));
}

}  // namespace curbstone::bench::sensor_faults
