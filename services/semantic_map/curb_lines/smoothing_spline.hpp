#pragma once

#include <Eigen/Core>
#include <vector>

namespace curbstone::semantic_map::curb_lines {

/// A smoothing spline through points that were measured along a line: cubic B-splines on even knots, weighted least
/// squares with a penalty on the third differences of the coefficients (P-splines: Eilers and Marx 1996, eq. 4), which
/// leaves straight lines and even bends as they are (and a slight one on the second differences). Outliers count less
/// (Cauchy weights, two rounds).
class SmoothingSpline {
 public:
  /// What is measured: x, y, z in m, height of the step in m.
  using Values = Eigen::Vector4d;
  struct Sample {
    double s = 0;  ///< m along the line, in order
    Values values = Values::Zero();
    double weight = 1;
  };

  /// Needs at least one sample; the spline is valid from the first sample's s to the last one's.
  explicit SmoothingSpline(const std::vector<Sample>& samples);

  [[nodiscard]] double begin() const { return begin_; }
  [[nodiscard]] double end() const { return end_; }
  [[nodiscard]] Values at(double s) const;
  /// Per m.
  [[nodiscard]] Values derivative(double s) const;

 private:
  void fit(const std::vector<Sample>& samples, const std::vector<double>& weights);
  double begin_ = 0;
  double end_ = 0;
  Values origin_;
  std::vector<Values> coefficients_;
};

}  // namespace curbstone::semantic_map::curb_lines
