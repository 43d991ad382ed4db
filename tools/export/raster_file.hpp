#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "services/semantic_map/picture/canvas.hpp"
#include "tools/export/map_grid.hpp"

namespace curbstone::map_export {

/// @file
/// Rasters that GDAL, QGIS and image viewers read. Row 0 on top.

/// Writes a PNG with a palette: the value of a pixel is the class, its colour that of Table I.
void write_class_png(const MapGrid& grid, const std::string& path);
/// Writes a PNG of 8-bit gray with the values unchanged. Both throw PictureError.
void write_gray_png(int width, int height, std::span<const std::uint8_t> gray, const std::string& path);
/// Writes a PNG of gray and alpha, two bytes per pixel.
void write_gray_alpha_png(int width, int height, std::span<const std::uint8_t> gray_alpha, const std::string& path);

/// Raw float32, little-endian (.flt), without rounding. NaN becomes kNoValue.
inline constexpr float kNoValue = -9999;
[[nodiscard]] std::string float_bytes(std::span<const float> values);
/// The ESRI header (.hdr) for it.
[[nodiscard]] std::string float_header(int columns, int rows);

/// Binary PGM (P5) of 8 bits.
[[nodiscard]] std::string pgm_bytes(int width, int height, std::span<const std::uint8_t> gray);

}  // namespace curbstone::map_export
