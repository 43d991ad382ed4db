#pragma once

#include <string>
#include <vector>

#include "services/semantic_map/picture/canvas.hpp"
#include "services/semantic_map/tile/map_types.hpp"

namespace curbstone::semantic_map::picture {

/// The paper's Table I colours: road gray, curb green, obstacle black, wall or vehicle red, unknown dark green.
[[nodiscard]] Colour class_colour(tile::CellClass cell_class);

/// A line over the map, m in map, for example the ground truth.
struct PictureLine {
  std::vector<Eigen::Vector2d> points;
  Colour colour{255, 0, 200};
  double thickness = 1.5;  ///< pixels
};

struct PictureOptions {
  std::string title;        ///< empty: none
  int pixels_per_cell = 8;  ///< fewer where the picture would be larger than max_pixels
  int max_pixels = 3200;    ///< of the map's longer side
  bool shade = true;        ///< relief, lit from the north-west
  bool legend = true;       ///< with scale bar and arrow
  double margin = 1.5;      ///< m around what has been mapped
};

/// The map from above, x to the right, y up, with the driven path (m in map), curb lines and overlays on top.
struct MapPicture {
  std::vector<tile::MapTile> tiles;
  std::vector<tile::CurbLine> curbs;  ///< drawn as fine lines over the curb cells, dashed where inferred
  std::vector<Eigen::Vector2d> path;  ///< empty: none
  std::vector<PictureLine> overlays;
  std::string overlays_are = "truth";            ///< in the legend, in the first one's colour
  std::vector<tile::MarkingLine> markings = {};  ///< drawn white, as wide as they are, where they are painted
};

[[nodiscard]] Canvas draw_map(const MapPicture& map, const PictureOptions& options);

}  // namespace curbstone::semantic_map::picture
