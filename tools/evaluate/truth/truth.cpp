#include "tools/evaluate/truth/truth.hpp"

#include <fmt/format.h>
#include <png.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <stdexcept>

#include "common/json/json_text.hpp"

namespace curbstone::evaluate::truth {

namespace {

/// Reads rows of numbers from a CSV file; a first line that does not begin with a number is a heading.
std::vector<std::vector<double>> read_csv(const std::string& file, std::size_t columns) {
  std::ifstream in(file);
  if (!in) throw std::runtime_error(fmt::format("{}: cannot be read", file));
  std::vector<std::vector<double>> rows;
  std::string line;
  for (int number = 1; std::getline(in, line); ++number) {
    if (line.empty() || (number == 1 && std::isdigit(static_cast<unsigned char>(line[0])) == 0 && line[0] != '-'))
      continue;
    std::vector<double> row;
    std::stringstream cells(line);
    for (std::string cell; std::getline(cells, cell, ',');) {
      char* end = nullptr;
      row.push_back(std::strtod(cell.c_str(), &end));
      if (end == cell.c_str()) row.back() = std::nan("");
    }
    const bool finite = std::all_of(row.begin(), row.end(), [](double x) { return std::isfinite(x); });
    if (row.size() < columns || !finite)
      throw std::runtime_error(fmt::format("{}:{}: expected {} numbers", file, number, columns));
    rows.push_back(std::move(row));
  }
  return rows;
}

void read_gray_png(const std::string& file, TrueClasses& classes) {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  if (png_image_begin_read_from_file(&image, file.c_str()) == 0)
    throw std::runtime_error(fmt::format("{}: {}", file, image.message));
  image.format = PNG_FORMAT_GRAY;
  classes.width = static_cast<int>(image.width);
  classes.height = static_cast<int>(image.height);
  classes.pixels.resize(PNG_IMAGE_SIZE(image));
  if (png_image_finish_read(&image, nullptr, classes.pixels.data(), 0, nullptr) == 0) {
    throw std::runtime_error(fmt::format("{}: {}", file, image.message));
  }
}

}  // namespace

std::optional<std::size_t> TrueClasses::index(double x, double y) const {
  const double column = std::floor((x - origin_x) / resolution);
  const double row = height - 1 - std::floor((y - origin_y) / resolution);
  if (!(column >= 0 && column < width && row >= 0 && row < height)) return std::nullopt;
  return static_cast<std::size_t>(row) * static_cast<std::size_t>(width) + static_cast<std::size_t>(column);
}

std::uint8_t TrueClasses::at(double x, double y) const {
  const auto pixel = index(x, y);
  return pixel ? pixels[*pixel] : std::uint8_t{0};
}

void TrueClasses::set(double x, double y, std::uint8_t value) {
  if (const auto pixel = index(x, y)) pixels[*pixel] = value;
}

bool TrueClasses::known_around(double x, double y) const {
  constexpr double kSide = 0.24;  // m
  const auto known_near = [&](double cx, double cy) {
    for (const double dx : {0.0, -resolution, resolution}) {
      for (const double dy : {0.0, -resolution, resolution}) {
        if (at(cx + dx, cy + dy) != 0) return true;
      }
    }
    return false;
  };
  return known_near(x - kSide, y - kSide) && known_near(x - kSide, y + kSide) && known_near(x + kSide, y - kSide) &&
         known_near(x + kSide, y + kSide);
}

std::uint8_t Truth::class_of_cell(const Pose& T_truth_map, const Eigen::Vector3d& centre, double size,
                                  double slack) const {
  const Eigen::Vector3d middle = T_truth_map * centre;
  if (fine_classes.empty()) return classes.at(middle.x(), middle.y());
  const auto class_of_square = [&](double side) {
    constexpr std::uint8_t kRoad = 1;
    const int samples = std::max(1, static_cast<int>(std::lround(side / fine_classes.resolution)));
    std::uint8_t highest = 0;
    bool is_known = true;
    for (int i = 0; i < samples * samples; ++i) {
      const Eigen::Vector3d off(side * ((i % samples + 0.5) / samples - 0.5),
                                side * ((i / samples + 0.5) / samples - 0.5), 0);
      const Eigen::Vector3d at = middle + T_truth_map.linear() * off;
      const std::uint8_t found = fine_classes.at(at.x(), at.y());
      highest = std::max(highest, found);
      is_known = is_known && found != 0;
    }
    return highest == kRoad && !is_known ? std::uint8_t{0} : highest;
  };
  if (slack <= 0) return class_of_square(size);
  const std::uint8_t narrow = class_of_square(size - 2 * slack);
  return narrow == class_of_square(size + 2 * slack) ? narrow : std::uint8_t{0};
}

Truth load_truth(const std::string& folder) {
  namespace fs = std::filesystem;
  Truth truth;
  for (const auto& row : read_csv(folder + "/poses.csv", 8)) {
    const double position[3] = {row[1], row[2], row[3]};
    const double orientation[4] = {row[4], row[5], row[6], row[7]};
    const Pose pose = pose_from_arrays(position, orientation);
    if (!is_finite(pose)) {
      throw std::runtime_error(
          fmt::format("{}/poses.csv: utime {:.0f}: qw,qx,qy,qz is no unit quaternion", folder, row[0]));
    }
    truth.poses.push_back({static_cast<std::int64_t>(row[0]), pose});
  }
  if (truth.poses.empty()) throw std::runtime_error(fmt::format("{}/poses.csv: no poses", folder));
  std::sort(truth.poses.begin(), truth.poses.end(), [](const auto& a, const auto& b) { return a.utime < b.utime; });

  if (fs::exists(folder + "/curbs.csv")) {
    for (const auto& row : read_csv(folder + "/curbs.csv", 6)) {
      truth.curbs.push_back({static_cast<int>(row[0]), row[1], row[2], row[3], row[4], row[5] != 0.0});
    }
  }
  if (fs::exists(folder + "/classes.png")) {
    const std::string name = folder + "/truth.json";
    double fine_resolution = 0;
    try {
      const auto json = read_json(name);
      truth.classes.resolution = json.at("resolution_m").get<double>();
      truth.classes.origin_x = json.at("origin").at(0).get<double>();
      truth.classes.origin_y = json.at("origin").at(1).get<double>();
      fine_resolution = json.value("fine_resolution_m", 0.0);
    } catch (const nlohmann::json::exception& error) {
      throw std::runtime_error(fmt::format("{}: {}", name, error.what()));
    }
    read_gray_png(folder + "/classes.png", truth.classes);
    if (fs::exists(folder + "/fine_classes.png")) {
      if (!(fine_resolution > 0)) throw std::runtime_error(fmt::format("{}: fine_resolution_m is missing", name));
      truth.fine_classes = truth.classes;
      truth.fine_classes.resolution = fine_resolution;
      read_gray_png(folder + "/fine_classes.png", truth.fine_classes);
    }
  }
  return truth;
}

}  // namespace curbstone::evaluate::truth
