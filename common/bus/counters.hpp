#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>

namespace curbstone {

/// Named counts since the start of the process, published in SERVICE_STATUS. Names are dotted: the event, then its
/// reason ("refused.checksum"). Not thread-safe: each thread has its own set.
class Counters {
 public:
  void add(std::string_view name, std::int64_t amount = 1) {
    const auto it = values_.find(name);
    if (it == values_.end())
      values_.emplace(std::string(name), amount);
    else
      it->second += amount;
  }
  /// Adds all counts of another set to those of the same name.
  void add(const Counters& other) {
    for (const auto& [name, value] : other.values_) add(name, value);
  }
  /// Sets a count that is kept elsewhere, such as the kernel's drops, or a level.
  void set(std::string_view name, std::int64_t value) { values_.insert_or_assign(std::string(name), value); }
  /// Sets the counts of another set here too, in place of those of the same name.
  void set(const Counters& other) {
    for (const auto& [name, value] : other.values_) set(name, value);
  }
  /// The value of a count; 0 for a name that was never counted.
  [[nodiscard]] std::int64_t operator[](std::string_view name) const {
    const auto it = values_.find(name);
    return it == values_.end() ? 0 : it->second;
  }
  [[nodiscard]] const std::map<std::string, std::int64_t, std::less<>>& values() const { return values_; }

 private:
  std::map<std::string, std::int64_t, std::less<>> values_;
};

}  // namespace curbstone
