#include "services/semantic_map/picture/png_file.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <cstring>
#include <filesystem>

namespace curbstone::semantic_map::picture {

void write_png(const Canvas& canvas, const std::string& path) {
  // What is there and is no regular file (/dev/null, a named pipe) is written to as it is: to rename over it would, as
  // root, put a picture in a device's place.
  std::error_code ignored;
  const auto there = std::filesystem::status(path, ignored);
  const bool in_place = std::filesystem::exists(there) && !std::filesystem::is_regular_file(there);
  const std::string temporary = in_place ? path : path + ".part";
  errno = 0;
  const char* const defect = canvas.write_png(temporary);
  std::error_code error;
  if (defect == nullptr) {
    if (in_place) return;
    std::filesystem::rename(temporary, path, error);
    if (!error) return;
  }
  const std::string why = error ? error.message() : (errno != 0 ? std::strerror(errno) : defect);
  if (!in_place) std::filesystem::remove(temporary, ignored);
  throw PictureError(fmt::format("{}: cannot write the picture: {}", path, why));
}

}  // namespace curbstone::semantic_map::picture
