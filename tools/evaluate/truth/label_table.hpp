#pragma once

#include <cstdint>
#include <map>
#include <string>

namespace curbstone::evaluate::truth {

/// The surface of a labelled point, as far as it matters for curbs.
enum class Surface : std::uint8_t { kNone, kRoad, kParking, kSidewalk, kTerrain, kVegetation, kWall };
inline constexpr int kNumSurfaces = 7;

/// Maps labels to surfaces: those of SemanticKITTI (40 road, 44 parking, 48 sidewalk, 70 vegetation, 72 terrain, 10 car
/// and 50 building: wall), or those of `folder`/labels.csv, with rows of a label and one of the words road, parking,
/// sidewalk, terrain, vegetation, wall, none. Labels that are not listed are none.
class LabelTable {
 public:
  /// Throws std::runtime_error with a one-line message.
  explicit LabelTable(const std::string& folder);
  [[nodiscard]] Surface surface_of(std::uint16_t label) const;

 private:
  std::map<std::uint16_t, Surface> surfaces_;
};

}  // namespace curbstone::evaluate::truth
