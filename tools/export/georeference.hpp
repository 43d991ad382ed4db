#pragma once

#include <optional>
#include <string>

#include "tools/export/geo/geo_datum.hpp"
#include "tools/export/map_grid.hpp"

namespace curbstone::map_export {

/// The georeference of a raster: in map or, with a datum, in the datum's tangent plane (m east and north of it).
class Georeference {
 public:
  Georeference(const MapGrid& grid, const std::optional<geo::TangentPlane>& plane);

  /// ESRI world file: six lines, the affine map from (column, row) to the centre of the cell.
  [[nodiscard]] std::string world_file() const;
  /// GDAL's side-car file (NAME.aux.xml) with the projection; empty without a datum.
  [[nodiscard]] std::optional<std::string> projection_file() const;

 private:
  Eigen::Vector2d first_;   ///< centre of the top left cell
  Eigen::Vector2d column_;  ///< from a cell to the one on its right
  Eigen::Vector2d row_;     ///< from a cell to the one below it
  std::string wkt_;
};

}  // namespace curbstone::map_export
