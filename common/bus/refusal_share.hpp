#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>

namespace curbstone {

/// The share of a device's packets that a driver refuses, evaluated each second. More than kShare refused in a second
/// is a fault. It names the most frequent cause and stays until a second with a lower share. Status only: no product
/// depends on it. Times in us, of one clock, which may be set. One thread.
class RefusalShare {
 public:
  static constexpr double kShare = 0.05;
  static constexpr std::int64_t kWindow = 1'000'000;  ///< us
  /// A second with fewer packets than this is not evaluated: a silent line has a fault of its own.
  static constexpr std::int64_t kMinRefusals = 10;

  void used(std::int64_t now);
  /// `cause`: the name of the counter, "refused.checksum".
  void refused(std::int64_t now, std::string_view cause);
  /// Call it regularly, so that a second ends even if no packet arrives.
  void tick(std::int64_t now);

  /// "61 % of the packets of a second were refused, most of them refused.checksum (912 of 1493)".
  [[nodiscard]] const std::optional<std::string>& fault() const { return fault_; }

 private:
  void close();

  std::optional<std::int64_t> began_;
  std::int64_t used_ = 0;
  std::int64_t refused_ = 0;
  std::map<std::string, std::int64_t, std::less<>> causes_;
  std::optional<std::string> fault_;
};

}  // namespace curbstone
