#pragma once

#include <cstdint>

namespace curbstone::system_test {

/// How scarce the CPU has been on this machine since this began: "some" of /proc/pressure/cpu (PSI, Documentation/
/// accounting/psi.rst of the kernel).
class CpuPressure {
 public:
  CpuPressure();
  /// Share of the time in which some program waited for a core, 0..1; 0 where the kernel does not say.
  [[nodiscard]] double share() const;

 private:
  std::int64_t began_;   // us, steady clock
  std::int64_t waited_;  // us, when it began
};

}  // namespace curbstone::system_test
