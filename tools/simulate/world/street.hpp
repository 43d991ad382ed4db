#pragma once

#include <Eigen/Core>
#include <vector>

#include "tools/simulate/numerics/spline.hpp"

namespace curbstone::simulate::world {

enum class Side { kLeft = 1, kRight = -1 };

/// A lowered curb at a driveway.
struct DroppedKerb {
  double s = 0;       ///< m along the street
  double half = 1.7;  ///< m, half the opening; ramps of 0.7 m beyond
  double height = 0.02;
};

/// One side's curb along a street: its heights by stretch, and where it is lowered.
struct CurbSide {
  std::vector<double> heights;  ///< m, one per stretch, blended between
  double stretch = 25.0;        ///< m
  std::vector<DroppedKerb> dropped;

  /// Height of the pavement behind, and of the curb, at s.
  [[nodiscard]] double full_height(double s, double street_length, bool closed) const;
  [[nodiscard]] double height(double s, double street_length, bool closed) const;
};

/// A street's centre line, by arc length, with its curbs. Frame: world, plan view.
class Street {
 public:
  struct Sample {
    Eigen::Vector2d point;
    Eigen::Vector2d tangent;                                                              ///< unit
    double s = 0;                                                                         ///< m from the start
    [[nodiscard]] Eigen::Vector2d normal() const { return {-tangent.y(), tangent.x()}; }  ///< to the left
  };

  Street(const numerics::Spline<Eigen::Vector2d>& line, double half_width);

  [[nodiscard]] const std::vector<Sample>& samples() const { return samples_; }
  [[nodiscard]] double length() const { return length_; }
  [[nodiscard]] bool closed() const { return closed_; }
  [[nodiscard]] double half_width() const { return half_width_; }
  /// Linear interpolation between samples half a metre apart; wraps or clamps.
  [[nodiscard]] Sample at(double s) const;
  [[nodiscard]] CurbSide& curb(Side side) { return side == Side::kLeft ? left_ : right_; }
  [[nodiscard]] const CurbSide& curb(Side side) const { return side == Side::kLeft ? left_ : right_; }

 private:
  std::vector<Sample> samples_;
  double length_ = 0;
  double half_width_;
  bool closed_;
  CurbSide left_, right_;
};

}  // namespace curbstone::simulate::world
