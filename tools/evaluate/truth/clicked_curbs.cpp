#include "tools/evaluate/truth/clicked_curbs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string_view>
#include <vector>

namespace curbstone::evaluate::truth {

namespace {

constexpr double kSpacing = 0.1;       // m
constexpr double kBeside = 3.0;        // m beside a clicked line in which there is no other curb
constexpr double kUsualHeight = 0.12;  // m, of a curb without a given height

TrueCurbPoint point_of(const std::string& line, const std::string& file, int number) {
  std::istringstream row(line);
  std::vector<double> values;
  for (std::string value; std::getline(row, value, ',');) {
    std::istringstream word(value);
    double number = 0;
    std::string more;
    if (!(word >> number) || word >> more) {  // not "3.5 m"
      values.clear();
      break;
    }
    values.push_back(number);
  }
  const bool is_sound = std::all_of(values.begin(), values.end(), [](double v) { return std::abs(v) < 1e5; });
  if (!is_sound || (values.size() != 3 && values.size() != 6))
    throw std::runtime_error(fmt::format("{}:{}: expected line,x,y or line,x,y,z,height,dropped", file, number));
  TrueCurbPoint point{static_cast<int>(values[0]), values[1], values[2], 0, kUsualHeight, false};
  if (values.size() == 6) {
    point.z = values[3];
    point.height = values[4];
    point.dropped = values[5] != 0;
  }
  return point;
}

std::vector<TrueCurbPoint> read_clicks(const std::string& file) {
  std::ifstream in(file);
  if (!in) throw std::runtime_error(fmt::format("{}: cannot be read", file));
  std::vector<TrueCurbPoint> clicks;
  int number = 0;
  for (std::string line; std::getline(in, line);) {
    ++number;
    if (!line.empty() && line.back() == '\r') line.pop_back();
    constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";  // as spreadsheets write it
    if (number == 1 && line.starts_with(kByteOrderMark)) line.erase(0, kByteOrderMark.size());
    if (line.empty() || line.front() == '#' || (number == 1 && line.starts_with("line"))) continue;
    clicks.push_back(point_of(line, file, number));
  }
  if (clicks.size() < 2) throw std::runtime_error(fmt::format("{}: no line of two points", file));
  return clicks;
}

/// Visits a point every 0.1 m from each click to the next of its line.
template <class Visit>
void walk(const std::vector<TrueCurbPoint>& clicks, Visit visit) {
  for (std::size_t i = 0; i < clicks.size(); ++i) {
    const TrueCurbPoint& a = clicks[i];
    const bool goes_on = i + 1 < clicks.size() && clicks[i + 1].line == a.line;
    const TrueCurbPoint& b = goes_on ? clicks[i + 1] : a;
    const double length = std::hypot(b.x - a.x, b.y - a.y);
    const int pieces = std::max(1, static_cast<int>(std::ceil(length / kSpacing)));
    const double along_x = length > 0 ? (b.x - a.x) / length : 0;
    const double along_y = length > 0 ? (b.y - a.y) / length : 0;
    for (int k = 0; k < pieces; ++k) {
      const double f = static_cast<double>(k) / pieces;
      TrueCurbPoint at = a;
      at.x += f * (b.x - a.x);
      at.y += f * (b.y - a.y);
      at.z += f * (b.z - a.z);
      at.height += f * (b.height - a.height);
      visit(at, along_x, along_y);
    }
  }
}

}  // namespace

bool has_clicked_curbs(const std::string& folder) {
  return std::filesystem::exists(folder + "/curbs.csv");
}

StreetLabels read_clicked_curbs(const std::string& folder, const Pose& T_world_first) {
  std::vector<TrueCurbPoint> clicks = read_clicks(folder + "/curbs.csv");
  for (TrueCurbPoint& click : clicks) {
    const Eigen::Vector3d at = T_world_first * Eigen::Vector3d(click.x, click.y, click.z);
    click.x = at.x();
    click.y = at.y();
    click.z = at.z();
  }
  StreetLabels labels;
  const auto by_x = std::minmax_element(clicks.begin(), clicks.end(), [](auto& a, auto& b) { return a.x < b.x; });
  const auto by_y = std::minmax_element(clicks.begin(), clicks.end(), [](auto& a, auto& b) { return a.y < b.y; });
  TrueClasses& known = labels.classes;
  known.origin_x = by_x.first->x - kBeside;
  known.origin_y = by_y.first->y - kBeside;
  const auto pixels = [&](double low, double high) {
    return static_cast<int>((high - low + 2 * kBeside) / known.resolution) + 1;
  };
  known.width = pixels(by_x.first->x, by_x.second->x);
  known.height = pixels(by_y.first->y, by_y.second->y);
  if (known.width > 10'000 || known.height > 10'000)
    throw std::runtime_error(fmt::format("{}/curbs.csv: lies more than a kilometre apart", folder));
  known.pixels.assign(static_cast<std::size_t>(known.width) * static_cast<std::size_t>(known.height), 0);
  walk(clicks, [&](const TrueCurbPoint& at, double along_x, double along_y) {
    labels.curbs.push_back(at);
    for (double off = -kBeside; off <= kBeside; off += 0.5 * known.resolution)
      known.set(at.x - off * along_y, at.y + off * along_x, StreetLabels::kLabelledOnly);
  });
  return labels;
}

}  // namespace curbstone::evaluate::truth
