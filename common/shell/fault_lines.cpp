#include "common/shell/fault_lines.hpp"

#include <algorithm>

namespace curbstone {

namespace {

bool is_digit(char c) {
  return c >= '0' && c <= '9';
}

}  // namespace

std::string without_numbers(const std::string& text) {
  std::string key;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const bool in_number = !key.empty() && key.back() == '#';
    const bool point = text[i] == '.' && in_number && i + 1 < text.size() && is_digit(text[i + 1]);
    if (point || (in_number && is_digit(text[i]))) continue;
    key += is_digit(text[i]) ? '#' : text[i];
  }
  return key;
}

void FaultLines::hold(const std::string& text, std::int64_t now) {
  const std::string key = without_numbers(text);
  auto found = known_.find(key);
  if (found == known_.end()) {
    if (known_.size() >= kMaxFaults) return;
    found = known_.emplace(key, Fault{}).first;
  }
  Fault& fault = found->second;
  if (fault.since == 0) fault.since = now;
  fault.text = text;
  fault.held_at = now;
}

std::vector<std::string> FaultLines::update(const std::vector<std::string>& faults, std::int64_t now) {
  for (const std::string& text : faults) hold(text, now);
  std::vector<std::string> lines;
  for (auto& [key, fault] : known_) {
    const bool holds = fault.held_at == now;
    if (holds && !fault.written && now - fault.since >= kStays && now >= fault.due) {
      lines.push_back(fault.text);
      fault.written = true;
      fault.due = now + fault.pause;
      fault.pause = std::min(2 * fault.pause, kMaxPause);
    }
    if (!holds && fault.written) lines.push_back("over: " + fault.text);
    if (!holds) fault.written = false, fault.since = 0;
  }
  std::erase_if(known_, [now](const auto& entry) { return now - entry.second.held_at > kMaxPause; });
  return lines;
}

}  // namespace curbstone
