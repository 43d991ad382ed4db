#pragma once

#include <cstdint>
#include <memory>
#include <string>

namespace curbstone::semantic_map::picture {

struct Colour {
  std::uint8_t r = 0, g = 0, b = 0;
  bool operator==(const Colour&) const = default;
};

/// `share` of b over a, 0..1.
[[nodiscard]] Colour mix(Colour a, Colour b, double share);

/// An image of 8-bit RGB, drawn with Cairo; row 0 is the top. Drawing outside of it is clipped. Filled pixels get the
/// exact colour; lines and text are anti-aliased.
class Canvas {
 public:
  /// At most 32767 pixels a side, which is Cairo's limit.
  Canvas(int width, int height, Colour background);
  ~Canvas();
  Canvas(Canvas&& other) noexcept;
  Canvas& operator=(Canvas&& other) noexcept;

  [[nodiscard]] int width() const;
  [[nodiscard]] int height() const;
  [[nodiscard]] Colour at(int x, int y) const;

  void fill(int x, int y, int width, int height, Colour colour);
  /// With round ends.
  void line(double x0, double y0, double x1, double y1, double thickness, Colour colour, double opacity = 1);
  void disc(double x, double y, double radius, Colour colour, double opacity = 1);
  /// UTF-8; capitals are kTextHeight * scale pixels high; (x, y) is the upper left corner of a capital. Where no font
  /// is installed there are no words in the picture.
  void text(int x, int y, const std::string& text, int scale, Colour colour);
  [[nodiscard]] int text_width(const std::string& text, int scale) const;
  static constexpr int kTextHeight = 7;

  /// Returns the error; nullptr if there is none.
  const char* write_png(const std::string& path) const;

 private:
  struct Image;  // Cairo's
  [[nodiscard]] std::uint32_t* row(int y) const;
  void use(Colour colour, double opacity);

  std::unique_ptr<Image> image_;
};

}  // namespace curbstone::semantic_map::picture
