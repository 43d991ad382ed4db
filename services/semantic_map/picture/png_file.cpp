#include "services/semantic_map/picture/png_file.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <cstring>
#include <filesystem>

namespace curbstone::semantic_map::picture {

void write_png(const Canvas& canvas, const std::string& path) {
  const std::string temporary = path + ".part";
  errno = 0;
  const char* const defect = canvas.write_png(temporary);
  std::error_code error;
  if (defect == nullptr) {
    std::filesystem::rename(temporary, path, error);
    if (!error) return;
  }
  const std::string why = error ? error.message() : (errno != 0 ? std::strerror(errno) : defect);
  std::filesystem::remove(temporary, error);
  throw PictureError(fmt::format("{}: cannot write the picture: {}", path, why));
}

}  // namespace curbstone::semantic_map::picture
