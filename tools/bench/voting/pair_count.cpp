#include "tools/bench/voting/pair_count.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <compare>
#include <thread>
#include <vector>

namespace curbstone::bench::voting {

namespace {

struct Column {
  std::int64_t x, y;
  auto operator<=>(const Column&) const = default;
};

/// Points sorted by vertical column of edge `radius`; no bins along z, because streets are flat.
struct Columns {
  std::vector<Column> keys;
  std::vector<std::size_t> begins;  // one more than keys
  std::vector<float> x, y, z;

  Columns(std::span<const Eigen::Vector3d> points, double radius) {
    std::vector<std::pair<Column, std::size_t>> order;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const auto index = [&](int axis) { return static_cast<std::int64_t>(std::floor(points[i][axis] / radius)); };
      order.push_back({{index(0), index(1)}, i});
    }
    std::sort(order.begin(), order.end());
    for (const auto& [key, i] : order) {
      if (keys.empty() || keys.back() != key) keys.push_back(key), begins.push_back(x.size());
      const Eigen::Vector3f local = (points[i] - points[0]).cast<float>();
      x.push_back(local.x()), y.push_back(local.y()), z.push_back(local.z());
    }
    begins.push_back(x.size());
  }

  /// Pairs of a point of column a with a point of column b.
  [[nodiscard]] std::int64_t pairs(std::size_t a, std::size_t b, float radius2) const {
    std::int64_t total = 0;
    for (std::size_t i = begins[a]; i < begins[a + 1]; ++i) {
      std::int32_t near = 0;
      for (std::size_t j = begins[b]; j < begins[b + 1]; ++j) {
        const float dx = x[i] - x[j], dy = y[i] - y[j], dz = z[i] - z[j];
        near += dx * dx + dy * dy + dz * dz < radius2 ? 1 : 0;
      }
      total += near;
    }
    return total;
  }
};

}  // namespace

std::int64_t count_pair_votes(std::span<const Eigen::Vector3d> points, double radius, int threads) {
  const Columns columns(points, radius);
  const auto radius2 = static_cast<float>(radius * radius);
  constexpr std::array<Column, 4> kOneHalf = {{{1, 0}, {-1, 1}, {0, 1}, {1, 1}}};
  std::atomic<std::size_t> next{0};
  std::atomic<std::int64_t> total{0};
  const auto work = [&] {
    for (std::size_t a = next++; a < columns.keys.size(); a = next++) {
      const auto own = static_cast<std::int64_t>(columns.begins[a + 1] - columns.begins[a]);
      total += columns.pairs(a, a, radius2) - own;  // no point votes for itself
      for (const Column& step : kOneHalf) {
        const Column key{columns.keys[a].x + step.x, columns.keys[a].y + step.y};
        const auto it = std::lower_bound(columns.keys.begin(), columns.keys.end(), key);
        if (it == columns.keys.end() || *it != key) continue;
        total += 2 * columns.pairs(a, static_cast<std::size_t>(it - columns.keys.begin()), radius2);
      }
    }
  };
  {
    std::vector<std::jthread> helpers;
    for (int t = 1; t < threads; ++t) helpers.emplace_back(work);
    work();
  }
  return total;
}

}  // namespace curbstone::bench::voting
