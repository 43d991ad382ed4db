#include "services/mapper/registration/plane_matches.hpp"

#include <algorithm>
#include <cmath>

namespace curbstone::mapper::registration {
namespace {

constexpr std::size_t kBlock = 64;  // groups of four whose sums are accumulated as floats
constexpr float kNowhere = 1e9F;    // m: beyond any kernel's reach, for lanes without a match

}  // namespace

/// Sums over a block of matches.
struct PlaneMatches::Sums {
  Lanes H[21]{};  // the upper triangle, row by row
  Lanes b[6]{};
  Lanes weight{}, lever{}, squared_error{}, inliers{};

  static double total(const Lanes& v) {
    return (static_cast<double>(v[0]) + static_cast<double>(v[1])) +
           (static_cast<double>(v[2]) + static_cast<double>(v[3]));
  }

  void add_to(NormalEquations& out) const {
    for (int i = 0, k = 0; i < 6; ++i) {
      out.b[i] += total(b[i]);
      for (int j = i; j < 6; ++j, ++k) out.H(i, j) += total(H[k]);
    }
    out.weight += total(weight);
    out.lever += total(lever);
    out.squared_error += total(squared_error);
    out.inliers += static_cast<int>(total(inliers));
  }
};

void PlaneMatches::add(const Eigen::Vector3f& p, const Eigen::Vector3f& n, double distance, double variance) {
  const std::size_t lane = size_ % kLanes;
  if (lane == 0) {
    const Lanes none{}, nowhere = none + kNowhere, one = none + 1.0F;
    fours_.push_back({{none, none, none}, {none, none, none}, nowhere, one});
  }
  Four& four = fours_.back();
  for (int axis = 0; axis < 3; ++axis) {
    four.p[axis][lane] = p[axis];
    four.n[axis][lane] = n[axis];
  }
  four.distance[lane] = static_cast<float>(distance);
  four.sigma[lane] = static_cast<float>(std::sqrt(variance));
  ++size_;
}

NormalEquations PlaneMatches::at(const Pose& moved, const RobustKernel& kernel) const {
  const Eigen::Matrix3f R = moved.linear().cast<float>();
  const Eigen::Matrix3f turned = (moved.linear() - Eigen::Matrix3d::Identity()).cast<float>();
  const Eigen::Vector3f shift = moved.translation().cast<float>();
  const auto reach = static_cast<float>(kernel.reach), bound = static_cast<float>(kernel.bound);
  const Lanes zero{}, one = zero + 1.0F;
  NormalEquations out;
  out.found = static_cast<int>(size_);
  for (std::size_t begin = 0; begin < fours_.size(); begin += kBlock) {
    Sums sums;
    for (std::size_t i = begin; i < std::min(begin + kBlock, fours_.size()); ++i) {
      const Four& m = fours_[i];
      Lanes r = m.distance;
      Lanes J[6];
      for (int k = 0; k < 3; ++k) {
        r += m.n[k] * (turned(k, 0) * m.p[0] + turned(k, 1) * m.p[1] + turned(k, 2) * m.p[2] + shift[k]);
        J[k] = R(0, k) * m.n[0] + R(1, k) * m.n[1] + R(2, k) * m.n[2];  // n in base_link's axes now
      }
      J[3] = m.p[1] * J[2] - m.p[2] * J[1];
      J[4] = m.p[2] * J[0] - m.p[0] * J[2];
      J[5] = m.p[0] * J[1] - m.p[1] * J[0];
      const Lanes error = r < 0 ? -r : r;
      const Lanes limit = m.sigma > bound ? m.sigma : zero + bound;
      const Lanes huber = error <= limit ? one : limit / error;
      const Lanes weight = error < reach ? huber / (m.sigma * m.sigma) : zero;
      const Lanes inlier = error < reach && error < 3 * limit ? one : zero;
      sums.weight += weight;
      sums.lever += weight * (m.p[0] * m.p[0] + m.p[1] * m.p[1] + m.p[2] * m.p[2]);
      sums.inliers += inlier;
      sums.squared_error += inlier * r * r;
      for (int a = 0, k = 0; a < 6; ++a) {
        const Lanes wJ = weight * J[a];
        sums.b[a] += wJ * r;
        for (int c = a; c < 6; ++c, ++k) sums.H[k] += wJ * J[c];
      }
    }
    sums.add_to(out);
  }
  out.H.triangularView<Eigen::StrictlyLower>() = out.H.transpose();
  return out;
}

}  // namespace curbstone::mapper::registration
