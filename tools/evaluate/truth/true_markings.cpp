#include "tools/evaluate/truth/true_markings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <utility>

namespace curbstone::evaluate::truth {

namespace {

using Type = TrueMarking::Type;

std::optional<Type> type_of(const std::string& word) {
  static const std::array<std::pair<const char*, Type>, 6> kTypes = {{{"solid", Type::kSolid},
                                                                      {"dashed", Type::kDashed},
                                                                      {"double", Type::kDouble},
                                                                      {"stop_line", Type::kStopLine},
                                                                      {"crossing", Type::kCrossing},
                                                                      {"other", Type::kOther}}};
  for (const auto& [name, type] : kTypes) {
    if (word == name) return type;
  }
  return std::nullopt;
}

struct VertexRow {
  long line = 0, piece = 0;
  Type type = Type::kSolid;
  double width = 0;
  Eigen::Vector3d at;
};

std::optional<double> number_in(const std::string& text) {
  char* end = nullptr;
  const double value = std::strtod(text.c_str(), &end);
  if (end == text.c_str() || !std::isfinite(value)) return std::nullopt;
  return value;
}

std::optional<VertexRow> vertex_in(const std::string& line) {
  std::vector<std::string> cells;
  std::stringstream text(line);
  for (std::string cell; std::getline(text, cell, ',');) cells.push_back(cell);
  if (cells.size() < 7) return std::nullopt;
  const auto type = type_of(cells[2]);
  std::array<double, 6> numbers{};
  std::size_t n = 0;
  for (const std::size_t column : {0U, 1U, 3U, 4U, 5U, 6U}) {
    const auto number = number_in(cells[column]);
    if (!number || !type) return std::nullopt;
    numbers[n++] = *number;
  }
  if (!(numbers[2] > 0)) return std::nullopt;
  return VertexRow{static_cast<long>(numbers[0]),
                   static_cast<long>(numbers[1]),
                   *type,
                   numbers[2],
                   {numbers[3], numbers[4], numbers[5]}};
}

}  // namespace

std::vector<TrueMarking> read_markings(const std::string& folder) {
  const std::string file = folder + "/markings.csv";
  std::vector<TrueMarking> markings;
  if (!std::filesystem::exists(file)) return markings;
  std::ifstream in(file);
  if (!in) throw std::runtime_error(fmt::format("{}: cannot be read", file));
  std::string text;
  std::getline(in, text);  // heading
  long line = -1, piece = -1;
  for (int number = 2; std::getline(in, text); ++number) {
    if (text.empty()) continue;
    const auto row = vertex_in(text);
    if (!row)
      throw std::runtime_error(
          fmt::format("{}:{}: expected line,piece,type,width,x,y,z with a known type", file, number));
    if (row->line != line) markings.push_back({row->type, {}});
    if (row->line != line || row->piece != piece) markings.back().pieces.push_back({{}, row->width});
    line = row->line;
    piece = row->piece;
    markings.back().pieces.back().centre.push_back(row->at);
  }
  for (const TrueMarking& marking : markings) {
    if (std::any_of(marking.pieces.begin(), marking.pieces.end(), [](const auto& p) { return p.centre.size() < 2; }))
      throw std::runtime_error(fmt::format("{}: a piece has two vertices or more", file));
  }
  return markings;
}

}  // namespace curbstone::evaluate::truth
