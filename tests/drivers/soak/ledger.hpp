#pragma once

#include <array>
#include <cstdint>
#include <set>
#include <string>

#include "common/bus/node.hpp"
#include "tests/drivers/soak/damage.hpp"

namespace curbstone::test {

/// What was sent to a driver, and what came of it.
class Ledger {
 public:
  void sent(std::int64_t index, Fate fate);
  /// A message bears the packet with this index (negative: none that was sent); its stamp is off by `error` us.
  void used(std::int64_t index, std::int64_t error);
  /// From time to time: faults, and the memory of the process.
  void look(const NodeReport& report, double share_done);
  /// A table for people.
  void print(const std::string& sensor, double hours, double seconds, const NodeReport& report) const;

  [[nodiscard]] std::int64_t sent(Fate fate) const { return sent_[static_cast<std::size_t>(fate)]; }
  [[nodiscard]] std::int64_t used(Fate fate) const { return used_[static_cast<std::size_t>(fate)]; }
  [[nodiscard]] std::int64_t strange() const { return strange_; }          ///< used twice, or never sent
  [[nodiscard]] std::int64_t worst_error() const { return worst_error_; }  ///< us, signed
  [[nodiscard]] std::int64_t wrong() const { return wrong_; }  ///< stamps that are off by more than kStampError
  static constexpr std::int64_t kStampError = 1000;            ///< us
  /// bytes, from a tenth of the run to its end.
  [[nodiscard]] std::int64_t growth() const { return last_memory_ - first_memory_; }
  [[nodiscard]] const std::set<std::string>& faults() const { return faults_; }

 private:
  struct Entry {
    std::int64_t index = -1;
    Fate fate = Fate::kGood;
    bool used = false;
  };
  std::array<Entry, 4096> entries_;
  std::array<std::int64_t, kFates.size()> sent_{}, used_{};
  std::int64_t strange_ = 0;
  std::int64_t worst_error_ = 0, wrong_ = 0;
  std::int64_t first_memory_ = 0, last_memory_ = 0;
  std::set<std::string> faults_;  // their texts without numbers
};

}  // namespace curbstone::test
