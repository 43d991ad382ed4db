#include "services/semantic_map/drawing.hpp"

#include <algorithm>
#include <cmath>

#include "services/semantic_map/font.hpp"

namespace curbstone {

Colour mix(Colour a, Colour b, double share) {
  const auto channel = [share](std::uint8_t from, std::uint8_t to) {
    return static_cast<std::uint8_t>(std::lround(std::clamp(from + (to - from) * share, 0.0, 255.0)));
  };
  return {channel(a.r, b.r), channel(a.g, b.g), channel(a.b, b.b)};
}

Canvas::Canvas(int width, int height, Colour background)
    : width_(width), height_(height), rgb_(static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * 3) {
  fill(0, 0, width, height, background);
}

Colour Canvas::at(int x, int y) const {
  const std::uint8_t* p =
      &rgb_[(static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(x)) * 3];
  return {p[0], p[1], p[2]};
}

void Canvas::set(int x, int y, Colour colour, double opacity) {
  if (x < 0 || y < 0 || x >= width_ || y >= height_ || opacity <= 0) return;
  const Colour mixed = opacity >= 1 ? colour : mix(at(x, y), colour, opacity);
  std::uint8_t* p =
      &rgb_[(static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(x)) * 3];
  p[0] = mixed.r;
  p[1] = mixed.g;
  p[2] = mixed.b;
}

void Canvas::fill(int x, int y, int width, int height, Colour colour, double opacity) {
  for (int row = std::max(0, y); row < std::min(height_, y + height); ++row) {
    for (int column = std::max(0, x); column < std::min(width_, x + width); ++column) set(column, row, colour, opacity);
  }
}

void Canvas::line(double x0, double y0, double x1, double y1, double thickness, Colour colour, double opacity) {
  const double radius = thickness / 2;
  const double length2 = (x1 - x0) * (x1 - x0) + (y1 - y0) * (y1 - y0);
  const auto low = [&](double a, double b) { return static_cast<int>(std::floor(std::min(a, b) - radius - 1)); };
  const auto high = [&](double a, double b) { return static_cast<int>(std::ceil(std::max(a, b) + radius + 1)); };
  for (int y = std::max(0, low(y0, y1)); y <= std::min(height_ - 1, high(y0, y1)); ++y) {
    for (int x = std::max(0, low(x0, x1)); x <= std::min(width_ - 1, high(x0, x1)); ++x) {
      const double px = x + 0.5;
      const double py = y + 0.5;
      const double along =
          length2 > 0 ? std::clamp(((px - x0) * (x1 - x0) + (py - y0) * (y1 - y0)) / length2, 0.0, 1.0) : 0.0;
      const double distance = std::hypot(px - x0 - along * (x1 - x0), py - y0 - along * (y1 - y0));
      set(x, y, colour, opacity * std::clamp(radius + 0.5 - distance, 0.0, 1.0));
    }
  }
}

void Canvas::disc(double x, double y, double radius, Colour colour, double opacity) {
  line(x, y, x, y, 2 * radius, colour, opacity);
}

void Canvas::text(int x, int y, std::string_view text, int scale, Colour colour) {
  for (const char c : text) {
    if (c < ' ' || c > '~') continue;
    const auto& glyph = kFont[static_cast<std::size_t>(c - ' ')];
    for (int row = 0; row < kTextHeight; ++row) {
      for (int column = 0; column < 5; ++column) {
        if ((glyph[static_cast<std::size_t>(row)] >> (4 - column) & 1) != 0)
          fill(x + column * scale, y + row * scale, scale, scale, colour);
      }
    }
    x += 6 * scale;
  }
}

int Canvas::text_width(std::string_view text, int scale) {
  return text.empty() ? 0 : static_cast<int>(text.size()) * 6 * scale - scale;
}

}  // namespace curbstone
