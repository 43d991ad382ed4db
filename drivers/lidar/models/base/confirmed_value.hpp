#pragma once

#include <optional>

namespace curbstone::lidar::models {

/// A value that two consecutive packets agree on. A device information that differs from the previous one means that
/// the device was reconfigured, or that the packet is damaged (it has no checksum): the next one decides.
template <class Value>
class ConfirmedValue {
 public:
  /// Returns whether the agreed value has changed.
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
