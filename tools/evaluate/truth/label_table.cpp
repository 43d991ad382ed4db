#include "tools/evaluate/truth/label_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string_view>

namespace curbstone::evaluate::truth {

namespace {

const std::map<std::string_view, Surface> kNames = {
    {"road", Surface::kRoad},       {"parking", Surface::kParking},       {"sidewalk", Surface::kSidewalk},
    {"terrain", Surface::kTerrain}, {"vegetation", Surface::kVegetation}, {"wall", Surface::kWall},
    {"none", Surface::kNone}};

}  // namespace

LabelTable::LabelTable(const std::string& folder)
    : surfaces_{{40, Surface::kRoad},    {44, Surface::kParking}, {48, Surface::kSidewalk}, {70, Surface::kVegetation},
                {72, Surface::kTerrain}, {10, Surface::kWall},    {50, Surface::kWall}} {
  const std::string file = folder + "/labels.csv";
  if (!std::filesystem::exists(file)) return;
  surfaces_.clear();
  std::ifstream in(file);
  int number = 0;
  for (std::string line; std::getline(in, line);) {
    ++number;
    if (!line.empty() && line.back() == '\r') line.pop_back();
    if (line.empty() || line.front() == '#' || (number == 1 && line.starts_with("label"))) continue;
    const std::size_t comma = line.find(',');
    std::uint16_t label = 0;
    const char* const end = line.data() + std::min(comma, line.size());
    const auto [rest, error] = std::from_chars(line.data(), end, label);
    const auto name = comma == std::string::npos ? kNames.end() : kNames.find(std::string_view(line).substr(comma + 1));
    if (error != std::errc() || rest != end || name == kNames.end()) {
      throw std::runtime_error(
          fmt::format("{}:{}: expected LABEL,SURFACE with road, parking, sidewalk, terrain, vegetation, wall or none",
                      file, number));
    }
    surfaces_[label] = name->second;
  }
  if (surfaces_.empty()) throw std::runtime_error(fmt::format("{}: names no label", file));
}

Surface LabelTable::surface_of(std::uint16_t label) const {
  const auto it = surfaces_.find(label);
  return it == surfaces_.end() ? Surface::kNone : it->second;
}

}  // namespace curbstone::evaluate::truth
