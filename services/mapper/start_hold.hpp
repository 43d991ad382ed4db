#pragma once

#include <vector>

#include "services/mapper/dense_map/dense_worker.hpp"
#include "services/mapper/standstill.hpp"

namespace curbstone::mapper {

/// Keeps the first standstill out of the dense map, and drops it once the vehicle moves. Standing, sixteen beams draw
/// the same sixteen rings again and again, and the filter does not know its tilt to better than the accelerometer's
/// bias: 0.2 degrees put a ring 19 m ahead 6 cm off the road as it is found to be on the way, which is a curb to look
/// at. Pure; one thread.
class StartHold {
 public:
  using Insertion = dense_map::DenseWork::Insertion;

  /// `seconds`: after which a vehicle that has not moved is mapped all the same.
  explicit StartHold(double seconds) : seconds_(seconds) {}

  /// What goes in with the next scan: nothing while it is held; else what was held and not dropped, then the scan.
  [[nodiscard]] std::vector<Insertion> admit(Insertion next, const Standstill& standstill);
  /// What is held: the vehicle never moved, so that is all there is.
  [[nodiscard]] std::vector<Insertion> release();

 private:
  double seconds_;
  std::vector<Insertion> held_;
};

}  // namespace curbstone::mapper
