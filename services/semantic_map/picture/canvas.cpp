#include "services/semantic_map/picture/canvas.hpp"

#include <cairo.h>

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace curbstone::semantic_map::picture {

namespace {

constexpr double kEmsPerCapital = 1 / 0.729;  // of DejaVu Sans

}  // namespace

Colour mix(Colour a, Colour b, double share) {
  const auto channel = [share](std::uint8_t from, std::uint8_t to) {
    return static_cast<std::uint8_t>(std::lround(std::clamp(from + (to - from) * share, 0.0, 255.0)));
  };
  return {channel(a.r, b.r), channel(a.g, b.g), channel(a.b, b.b)};
}

struct Canvas::Image {
  Image(int width, int height)
      : surface(cairo_image_surface_create(CAIRO_FORMAT_RGB24, width, height)), context(cairo_create(surface)) {}
  ~Image() {
    cairo_destroy(context);
    cairo_surface_destroy(surface);
  }
  Image(const Image&) = delete;
  Image& operator=(const Image&) = delete;

  cairo_surface_t* surface;
  cairo_t* context;
};

Canvas::Canvas(int width, int height, Colour background) : image_(std::make_unique<Image>(width, height)) {
  cairo_set_line_cap(image_->context, CAIRO_LINE_CAP_ROUND);
  cairo_select_font_face(image_->context, "DejaVu Sans", CAIRO_FONT_SLANT_NORMAL, CAIRO_FONT_WEIGHT_NORMAL);
  fill(0, 0, width, height, background);
}

Canvas::~Canvas() = default;
Canvas::Canvas(Canvas&& other) noexcept = default;
Canvas& Canvas::operator=(Canvas&& other) noexcept = default;

int Canvas::width() const {
  return cairo_image_surface_get_width(image_->surface);
}

int Canvas::height() const {
  return cairo_image_surface_get_height(image_->surface);
}

Colour Canvas::at(int x, int y) const {
  cairo_surface_flush(image_->surface);
  const std::uint32_t pixel = row(y)[x];
  return {static_cast<std::uint8_t>(pixel >> 16), static_cast<std::uint8_t>(pixel >> 8),
          static_cast<std::uint8_t>(pixel)};
}

/// A pixel of CAIRO_FORMAT_RGB24 is 0x00RRGGBB, in the machine's order of bytes.
std::uint32_t* Canvas::row(int y) const {
  return reinterpret_cast<std::uint32_t*>(cairo_image_surface_get_data(image_->surface) +
                                          std::ptrdiff_t{y} * cairo_image_surface_get_stride(image_->surface));
}

void Canvas::use(Colour colour, double opacity) {
  cairo_set_source_rgba(image_->context, colour.r / 255.0, colour.g / 255.0, colour.b / 255.0, opacity);
}

/// Without Cairo: a map is a hundred thousand small squares, and a path for each takes three times as long.
void Canvas::fill(int x, int y, int width, int height, Colour colour) {
  const std::uint32_t pixel = std::uint32_t{colour.r} << 16 | std::uint32_t{colour.g} << 8 | colour.b;
  cairo_surface_flush(image_->surface);
  const int left = std::max(0, x);
  const int right = std::min(this->width(), x + width);
  for (int i = std::max(0, y); left < right && i < std::min(this->height(), y + height); ++i)
    std::fill(row(i) + left, row(i) + right, pixel);
  cairo_surface_mark_dirty(image_->surface);
}

void Canvas::line(double x0, double y0, double x1, double y1, double thickness, Colour colour, double opacity) {
  use(colour, opacity);
  cairo_set_line_width(image_->context, thickness);
  cairo_move_to(image_->context, x0, y0);
  cairo_line_to(image_->context, x1, y1);
  cairo_stroke(image_->context);
}

void Canvas::disc(double x, double y, double radius, Colour colour, double opacity) {
  line(x, y, x, y, 2 * radius, colour, opacity);
}

void Canvas::text(int x, int y, const std::string& text, int scale, Colour colour) {
  use(colour, 1);
  cairo_set_font_size(image_->context, kEmsPerCapital * kTextHeight * scale);
  cairo_move_to(image_->context, x, y + kTextHeight * scale);
  cairo_show_text(image_->context, text.c_str());
  cairo_new_path(image_->context);
}

int Canvas::text_width(const std::string& text, int scale) const {
  cairo_set_font_size(image_->context, kEmsPerCapital * kTextHeight * scale);
  cairo_text_extents_t extents{};
  cairo_text_extents(image_->context, text.c_str(), &extents);
  return static_cast<int>(std::ceil(extents.x_advance));
}

const char* Canvas::write_png(const std::string& path) const {
  const cairo_status_t status = cairo_surface_write_to_png(image_->surface, path.c_str());
  return status == CAIRO_STATUS_SUCCESS ? nullptr : cairo_status_to_string(status);
}

}  // namespace curbstone::semantic_map::picture
