#include "tools/export/raster_file.hpp"

#include <fmt/format.h>
#include <png.h>

#include <array>
#include <bit>
#include <cerrno>
#include <cmath>
#include <cstring>

#include "services/semantic_map/picture/map_picture.hpp"
#include "services/semantic_map/picture/png_file.hpp"

namespace curbstone::map_export {

namespace {

void write(png_image& image, const void* pixels, const void* palette, const std::string& path) {
  errno = 0;
  if (png_image_write_to_file(&image, path.c_str(), 0, pixels, 0, palette) != 0) return;
  throw semantic_map::picture::PictureError(
      fmt::format("{}: cannot write the picture: {}", path, errno != 0 ? std::strerror(errno) : image.message));
}

png_image image_of(int width, int height, png_uint_32 format) {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = static_cast<png_uint_32>(width);
  image.height = static_cast<png_uint_32>(height);
  image.format = format;
  return image;
}

}  // namespace

void write_class_png(const MapGrid& grid, const std::string& path) {
  std::array<std::uint8_t, 3 * semantic_map::tile::kNumClasses> palette{};
  for (std::size_t i = 0; i < semantic_map::tile::kNumClasses; ++i) {
    const semantic_map::picture::Colour colour =
        semantic_map::picture::class_colour(static_cast<semantic_map::tile::CellClass>(i));
    palette[3 * i] = colour.r;
    palette[3 * i + 1] = colour.g;
    palette[3 * i + 2] = colour.b;
  }
  png_image image = image_of(grid.columns, grid.rows, PNG_FORMAT_RGB_COLORMAP);
  image.colormap_entries = semantic_map::tile::kNumClasses;
  static_assert(sizeof(semantic_map::tile::CellClass) == 1);
  write(image, grid.cell_class.data(), palette.data(), path);
}

void write_gray_png(int width, int height, std::span<const std::uint8_t> gray, const std::string& path) {
  png_image image = image_of(width, height, PNG_FORMAT_GRAY);
  write(image, gray.data(), nullptr, path);
}

void write_gray_alpha_png(int width, int height, std::span<const std::uint8_t> gray_alpha, const std::string& path) {
  png_image image = image_of(width, height, PNG_FORMAT_GA);
  write(image, gray_alpha.data(), nullptr, path);
}

std::string float_bytes(std::span<const float> values) {
  std::string bytes;
  bytes.reserve(4 * values.size());
  for (const float value : values) {
    const auto bits = std::bit_cast<std::uint32_t>(std::isnan(value) ? kNoValue : value);
    for (int shift = 0; shift < 32; shift += 8) bytes.push_back(static_cast<char>(bits >> shift & 0xff));
  }
  return bytes;
}

std::string float_header(int columns, int rows) {
  return fmt::format(
      "NROWS {}\nNCOLS {}\nNBANDS 1\nNBITS 32\nPIXELTYPE FLOAT\nBYTEORDER I\nLAYOUT BIL\nNODATA {:.0f}\n", rows,
      columns, static_cast<double>(kNoValue));
}

std::string pgm_bytes(int width, int height, std::span<const std::uint8_t> gray) {
  std::string bytes = fmt::format("P5\n{} {}\n255\n", width, height);
  bytes.append(gray.begin(), gray.end());
  return bytes;
}

}  // namespace curbstone::map_export
