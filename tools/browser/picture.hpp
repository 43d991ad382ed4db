#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace curbstone::browser {

using Rgb = std::array<int, 3>;

/// The pixels of a picture; (0, 0) is the upper left one.
class Picture {
 public:
  /// Throws std::runtime_error.
  explicit Picture(const std::string& png);

  [[nodiscard]] int width() const { return width_; }
  [[nodiscard]] int height() const { return height_; }
  [[nodiscard]] Rgb at(double x, double y) const;

 private:
  int width_ = 0;
  int height_ = 0;
  std::vector<std::uint8_t> rgb_;
};

/// The largest difference of any channel.
[[nodiscard]] int difference(const Rgb& a, const Rgb& b);

}  // namespace curbstone::browser
