#pragma once

#include <cstdint>
#include <map>
#include <string>

namespace curbstone::evaluate::truth {

/// What a labelled point is of, as far as curbs ask.
enum class Surface : std::uint8_t { kNone, kRoad, kParking, kSidewalk, kTerrain, kVegetation, kWall };
inline constexpr int kNumSurfaces = 7;

/// Which labels are which surface: SemanticKITTI's (40 road, 44 parking, 48 sidewalk, 70 vegetation, 72 terrain, 10 car
/// and 50 building: wall), or those of `folder`/labels.csv, with rows of a label and one of the words road, parking,
/// sidewalk, terrain, vegetation, wall, none. Labels that are not named are none.
class LabelTable {
 public:
  /// Throws std::runtime_error with one clear line.
  explicit LabelTable(const std::string& folder);
  [[nodiscard]] Surface surface_of(std::uint16_t label) const;

 private:
  std::map<std::uint16_t, Surface> surfaces_;
};

}  // namespace curbstone::evaluate::truth
