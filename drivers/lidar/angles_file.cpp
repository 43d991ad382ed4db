#include "drivers/lidar/angles_file.hpp"

#include <fmt/format.h>

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <stdexcept>
#include <string_view>

namespace curbstone::lidar {

namespace {

constexpr std::size_t kMaxLasers = 128;

/// Parses a number at `text` and moves behind it. Returns false if there is none, or none within +-180.
bool read_angle(const char*& text, double& angle) {
  char* end = nullptr;
  angle = std::strtod(text, &end);
  if (end == text || !std::isfinite(angle) || std::abs(angle) > 180.0) return false;
  text = end;
  while (*text == ' ' || *text == '\t' || *text == '\r') ++text;
  return true;
}

}  // namespace

std::vector<models::LaserAngles> read_angles(const std::string& file) {
  std::ifstream stream(file);
  if (!stream) throw std::runtime_error(fmt::format("angles_file: cannot read {}", file));
  std::vector<models::LaserAngles> angles;
  std::string line, ambiguous;
  bool has_points = false;
  constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";  // some editors write it
  for (int number = 1; std::getline(stream, line); ++number) {
    if (number == 1 && line.starts_with(kByteOrderMark)) line.erase(0, kByteOrderMark.size());
    const auto begin = line.find_first_not_of(" \t\r");
    if (begin == std::string::npos || line[begin] == '#') continue;
    models::LaserAngles laser;
    const char* text = line.c_str() + begin;
    bool good = read_angle(text, laser.elevation) && std::abs(laser.elevation) < 90.0;
    if (good && *text == ',') good = read_angle(++text, laser.azimuth);
    if (!good || *text != '\0' || angles.size() == kMaxLasers)
      throw std::runtime_error(fmt::format(
          "angles_file: {}:{}: expected elevation[,azimuth] in deg with decimal points, a line a laser", file, number));
    has_points = has_points || line.find('.') != std::string::npos;
    if (laser.azimuth != 0 && ambiguous.empty()) ambiguous = fmt::format("{}:{}", file, number);
    angles.push_back(laser);
  }
  if (!has_points && !ambiguous.empty())  // "-13,5" of a program that writes decimal commas
    throw std::runtime_error(
        fmt::format("angles_file: {}: is this comma a decimal one? Nowhere in the file is a decimal point: write -13.5 "
                    "for an elevation, -13.0,5.0 for elevation and azimuth",
                    ambiguous));
  if (angles.empty()) throw std::runtime_error(fmt::format("angles_file: {} has no angles", file));
  return angles;
}

}  // namespace curbstone::lidar
