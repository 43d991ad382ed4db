#include "procman/deputy/drive_mark.hpp"

#include <chrono>
#include <filesystem>
#include <system_error>

namespace curbstone::procman::deputy {
namespace {

constexpr auto kGoesOnFor = std::chrono::seconds(20);

}  // namespace

bool is_of_broken_off_drive(const std::string& file) {
  std::error_code error;
  const auto written = std::filesystem::last_write_time(file, error);
  if (error) return false;
  const auto age = std::filesystem::file_time_type::clock::now() - written;
  return age < kGoesOnFor && age > -kGoesOnFor;  // else the clock was set back
}

}  // namespace curbstone::procman::deputy
