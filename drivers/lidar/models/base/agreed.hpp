#pragma once

#include <optional>

namespace curbstone::lidar::models {

/// What two in a row say. A device that says of itself what the packet before did not say may have been set otherwise,
/// or the packet is damaged, for it has no checksum: the next one tells.
template <class Value>
class Agreed {
 public:
  /// Returns whether what is agreed on changed.
  bool offer(const Value& value) {
    const bool agree = last_ && *last_ == value;
    last_ = value;
    if (!agree || (agreed_ && *agreed_ == value)) return false;
    agreed_ = value;
    return true;
  }
  [[nodiscard]] const std::optional<Value>& value() const { return agreed_; }

 private:
  std::optional<Value> last_;
  std::optional<Value> agreed_;
};

}  // namespace curbstone::lidar::models
