#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace curbstone::simulate::truth {

/// 8-bit gray, row 0 on top.
struct GrayImage {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> pixels;

  GrayImage(int w, int h) : width(w), height(h), pixels(static_cast<std::size_t>(w) * static_cast<std::size_t>(h), 0) {}
  [[nodiscard]] std::uint8_t& at(int column, int row) {
    return pixels[static_cast<std::size_t>(row) * static_cast<std::size_t>(width) + static_cast<std::size_t>(column)];
  }
};

/// Throws std::runtime_error if the file cannot be written.
void write_png(const std::string& file, const GrayImage& image);

}  // namespace curbstone::simulate::truth
