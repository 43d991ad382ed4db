#include "services/semantic_map/png_file.hpp"

#include <fmt/format.h>
#include <png.h>

#include <cerrno>
#include <cstring>
#include <filesystem>

namespace curbstone {

void write_png(const Canvas& canvas, const std::string& path) {
  // libpng's simplified interface reports errors in the struct: nothing jumps.
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = static_cast<png_uint_32>(canvas.width());
  image.height = static_cast<png_uint_32>(canvas.height());
  image.format = PNG_FORMAT_RGB;
  const std::string temporary = path + ".part";
  errno = 0;
  const int written = png_image_write_to_file(&image, temporary.c_str(), 0, canvas.bytes().data(), 0, nullptr);
  std::error_code error;
  if (written != 0) {
    std::filesystem::rename(temporary, path, error);
    if (!error) return;
  }
  const std::string why = error ? error.message() : (errno != 0 ? std::strerror(errno) : image.message);
  std::filesystem::remove(temporary, error);
  throw PictureError(fmt::format("{}: cannot write the picture: {}", path, why));
}

}  // namespace curbstone
