#include "tools/output/text_file.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <stdexcept>
#include <string>

#include "tools/output/new_file.hpp"

namespace curbstone::output {

namespace {

void write(const std::filesystem::path& file, const std::string& where, std::string_view text) {
  std::ofstream out(where, std::ios::binary);
  out << text;
  out.close();
  if (!out) throw std::runtime_error(fmt::format("{}: cannot be written: {}", file.string(), std::strerror(errno)));
}

}  // namespace

void write_text(const std::filesystem::path& file, std::string_view text) {
  NewFile whole(file, true);
  write(file, whole.part(), text);
  whole.commit();
}

}  // namespace curbstone::output
