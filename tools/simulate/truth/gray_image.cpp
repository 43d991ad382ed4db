#include "tools/simulate/truth/gray_image.hpp"

#include <fmt/format.h>
#include <png.h>

#include <cerrno>
#include <cstring>
#include <stdexcept>

namespace curbstone::simulate::truth {

void write_png(const std::string& file, const GrayImage& image) {
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  png.width = static_cast<png_uint_32>(image.width);
  png.height = static_cast<png_uint_32>(image.height);
  png.format = PNG_FORMAT_GRAY;
  if (png_image_write_to_file(&png, file.c_str(), 0, image.pixels.data(), image.width, nullptr) == 0)
    throw std::runtime_error(fmt::format("{}: cannot be written: {}", file, png.message));
}

}  // namespace curbstone::simulate::truth
