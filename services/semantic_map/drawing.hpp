#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

namespace curbstone {

struct Colour {
  std::uint8_t r = 0, g = 0, b = 0;
  bool operator==(const Colour&) const = default;
};

/// `share` of b over a, 0..1.
[[nodiscard]] Colour mix(Colour a, Colour b, double share);

/// An image of 8-bit RGB; row 0 is the top. Drawing outside of it is cut off.
class Canvas {
 public:
  Canvas(int width, int height, Colour background);

  [[nodiscard]] int width() const { return width_; }
  [[nodiscard]] int height() const { return height_; }
  [[nodiscard]] Colour at(int x, int y) const;
  /// RGB, row by row from the top.
  [[nodiscard]] const std::vector<std::uint8_t>& bytes() const { return rgb_; }

  void set(int x, int y, Colour colour, double opacity = 1);
  void fill(int x, int y, int width, int height, Colour colour, double opacity = 1);
  /// Anti-aliased, with round ends.
  void line(double x0, double y0, double x1, double y1, double thickness, Colour colour, double opacity = 1);
  void disc(double x, double y, double radius, Colour colour, double opacity = 1);
  /// 5 x 7 dots a letter, `scale` pixels a dot; (x, y) is the upper left corner. Printable ASCII.
  void text(int x, int y, std::string_view text, int scale, Colour colour);
  [[nodiscard]] static int text_width(std::string_view text, int scale);
  static constexpr int kTextHeight = 7;  ///< dots

 private:
  int width_;
  int height_;
  std::vector<std::uint8_t> rgb_;
};

}  // namespace curbstone
