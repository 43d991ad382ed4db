#include "tools/browser/picture.hpp"

#include <png.h>

#include <algorithm>
#include <cstdlib>
#include <stdexcept>

namespace curbstone::browser {

Picture::Picture(const std::string& png) {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  if (png_image_begin_read_from_memory(&image, png.data(), png.size()) == 0) throw std::runtime_error(image.message);
  image.format = PNG_FORMAT_RGB;
  rgb_.resize(PNG_IMAGE_SIZE(image));
  if (png_image_finish_read(&image, nullptr, rgb_.data(), 0, nullptr) == 0) throw std::runtime_error(image.message);
  width_ = static_cast<int>(image.width);
  height_ = static_cast<int>(image.height);
}

Rgb Picture::at(double x, double y) const {
  const int column = std::clamp(static_cast<int>(x), 0, width_ - 1);
  const int row = std::clamp(static_cast<int>(y), 0, height_ - 1);
  const std::uint8_t* pixel = &rgb_[static_cast<std::size_t>(3 * (row * width_ + column))];
  return {pixel[0], pixel[1], pixel[2]};
}

int difference(const Rgb& a, const Rgb& b) {
  return std::max({std::abs(a[0] - b[0]), std::abs(a[1] - b[1]), std::abs(a[2] - b[2])});
}

}  // namespace curbstone::browser
