#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>

namespace curbstone {

/// Named counts since the start of the process, published in SERVICE_STATUS. Names are dotted: what, then why
/// ("refused.checksum"). Not thread-safe: each thread has its own set.
class Counters {
 public:
  void add(std::string_view name, std::int64_t amount = 1) {
    const auto it = values_.find(name);
    if (it == values_.end())
      values_.emplace(std::string(name), amount);
    else
      it->second += amount;
  }
  /// For a count that is kept elsewhere, as the kernel's drops are, and for a level.
  void set(std::string_view name, std::int64_t value) { values_.insert_or_assign(std::string(name), value); }
  /// 0 for a name that was never counted.
  [[nodiscard]] std::int64_t operator[](std::string_view name) const {
    const auto it = values_.find(name);
    return it == values_.end() ? 0 : it->second;
  }
  [[nodiscard]] const std::map<std::string, std::int64_t, std::less<>>& values() const { return values_; }

 private:
  std::map<std::string, std::int64_t, std::less<>> values_;
};

}  // namespace curbstone
