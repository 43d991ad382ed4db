#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "services/mapper/scan/scan.hpp"

namespace curbstone::mapper::mounting {

/// How the ground lies in base_link, where it should be z = 0: a plane z = height + pitch x + roll y.
struct GroundPlane {
  double height = 0;  ///< m, at the origin
  double along = 0;   ///< rise for a metre forward
  double across = 0;  ///< rise for a metre to the left
};

/// Where the ground is about the vehicle, on the way driven: in each cell of the strip that it drives in, ahead and
/// behind, the median height of what was seen there. Other vehicles, kerbs, crests and dips do not last; the mounting
/// of the LiDAR does. Revolutions of a vehicle that stands, brakes or leans in a bend are for the caller to leave out.
///
/// Remembers some kLeast to 2 kLeast looks. A function of the looks. Pure; one thread.
class GroundBelow {
 public:
  static constexpr int kLeast = 60;  ///< looks before anything is said

  GroundBelow() : cells_(kColumns * kRows) {}
  /// `points`: a revolution, in base_link.
  void look(const std::vector<scan::LidarPoint>& points);
  [[nodiscard]] int looks() const { return looks_; }
  /// Nothing before kLeast looks, or where too little ground was in sight.
  [[nodiscard]] std::optional<GroundPlane> plane() const;

 private:
  static constexpr int kColumns = 24;  // of 1 m, along x
  static constexpr int kRows = 8;      // of 0.5 m
  static constexpr int kBins = 150;    // of 2 cm
  struct Cell {
    std::array<std::uint16_t, kBins> heights{};
    int count = 0;
    [[nodiscard]] double median() const;
    void halve();
  };
  std::vector<Cell> cells_;
  int looks_ = 0;
};

}  // namespace curbstone::mapper::mounting
