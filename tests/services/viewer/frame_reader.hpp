#pragma once

#include <gtest/gtest.h>

#include <bit>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "common/bytes/little_endian.hpp"
#include "services/viewer/store/dense_cloud.hpp"
#include "services/viewer/store/tile_cells.hpp"

namespace curbstone::viewer {

/// What a page makes of its frames: written after frames/README.md, as page/decode.ts is.
class FrameReader {
 public:
  std::map<TileKey, store::TileCells> tiles;
  std::map<std::uint32_t, std::vector<float>> curbs;  ///< x of the vertices, by name
  struct Marking {
    int type = 0;
    float width = 0;  ///< m
    std::vector<float> x;
    std::vector<int> painted;
  };
  std::map<std::uint32_t, Marking> markings;
  std::vector<float> path;  ///< x, y, z by turns
  std::size_t num_points = 0;
  std::map<TileKey, std::vector<store::DenseCloud::Point>> cloud;
  double run = 0;
  std::int32_t epoch = 0;
  double number = 0;
  int begins = 0;
  std::string state;
  std::string services;

  /// Returns the frame's number.
  std::uint32_t read(std::span<const std::uint8_t> frame) {
    bytes_ = frame;
    const auto frame_number = take<std::uint32_t>();
    while (!bytes_.empty()) {
      const auto kind = take<std::uint8_t>();
      const auto length = take<std::uint32_t>();
      if (length > bytes_.size()) throw std::runtime_error("a section that ends too soon");
      const std::span<const std::uint8_t> rest = bytes_.subspan(length);
      bytes_ = bytes_.first(length);
      read_section(kind);
      EXPECT_TRUE(bytes_.empty()) << "kind " << int{kind};
      bytes_ = rest;
    }
    return frame_number;
  }

 private:
  template <class Number>
  Number take() {
    if (bytes_.size() < sizeof(Number)) throw std::runtime_error("a frame that ends too soon");
    const auto value = read_little_endian<Number>(bytes_);
    bytes_ = bytes_.subspan(sizeof(Number));
    return value;
  }
  std::int32_t take_i32() { return static_cast<std::int32_t>(take<std::uint32_t>()); }
  float take_f32() { return std::bit_cast<float>(take<std::uint32_t>()); }
  double take_f64() { return std::bit_cast<double>(take<std::uint64_t>()); }
  std::string take_text() {
    std::string text(bytes_.begin(), bytes_.end());
    bytes_ = {};
    return text;
  }

  void read_section(std::uint8_t kind) {
    switch (kind) {
      case 1:
        ++begins;
        run = take_f64();
        epoch = take_i32();
        tiles.clear();
        curbs.clear();
        markings.clear();
        path.clear();
        cloud.clear();
        return;
      case 2:
        number = take_f64();
        while (!bytes_.empty()) read_tile();
        return;
      case 3:
        return read_curbs();
      case 4:
        if (take<std::uint8_t>() != 0) path.clear();
        while (!bytes_.empty()) path.push_back(take_f32());
        return;
      case 5:
        num_points = bytes_.size() / 7;
        bytes_ = bytes_.subspan(7 * num_points);
        return;
      case 6:
        state = take_text();
        return;
      case 7:
        services = take_text();
        return;
      case 8:
        return read_markings();
      case 9:
        while (!bytes_.empty()) read_cloud_tile();
        return;
      default:
        throw std::runtime_error("an unknown section");
    }
  }

  void read_tile() {
    const std::int32_t x = take_i32();
    const std::int32_t y = take_i32();
    store::TileCells& tile = tiles[{x, y}];
    const bool is_whole = take<std::uint8_t>() == 0;
    tile.revision = take_i32();
    tile.utime = static_cast<std::int64_t>(take_f64());
    tile.curbs_utime = static_cast<std::int64_t>(take_f64());
    tile.z_origin = take_f32();
    std::vector<std::size_t> cells;
    std::vector<std::uint8_t> mask(79, 0xff);
    if (!is_whole) {
      for (std::uint8_t& byte : mask) byte = take<std::uint8_t>();
    }
    for (std::size_t i = 0; i < store::kCellsInTile; ++i) {
      if ((mask[i / 8] >> (i % 8) & 1) != 0) cells.push_back(i);
    }
    for (const std::size_t i : cells) tile.cell_class[i] = take<std::uint8_t>();
    for (const std::size_t i : cells) tile.height[i] = static_cast<std::int16_t>(take<std::uint16_t>());
    for (const std::size_t i : cells) tile.cost[i] = take<std::uint8_t>();
    for (const std::size_t i : cells) tile.confidence[i] = take<std::uint8_t>();
  }

  void read_cloud_tile() {
    const std::int32_t x = take_i32();
    auto& points = cloud[{x, take_i32()}];
    take_f32();
    points.resize(take<std::uint16_t>());
    for (auto runs = take<std::uint16_t>(); runs > 0; --runs) {
      const std::size_t first = take<std::uint16_t>();
      const std::size_t end = first + take<std::uint16_t>();
      for (std::size_t i = first; i < end; ++i) {
        store::DenseCloud::Point& point = points.at(i);
        for (auto* axis : {&point.x, &point.y, &point.z}) *axis = static_cast<std::int16_t>(take<std::uint16_t>());
        for (auto* value : {&point.intensity, &point.surface, &point.line}) *value = take<std::uint8_t>();
      }
    }
  }

  template <class Lines>
  void read_gone(Lines& lines) {
    take<std::uint32_t>();
    if (take<std::uint8_t>() != 0) lines.clear();
    for (auto gone = take<std::uint32_t>(); gone > 0; --gone) EXPECT_EQ(lines.erase(take<std::uint32_t>()), 1U);
  }

  void read_markings() {
    read_gone(markings);
    for (auto lines = take<std::uint32_t>(); lines > 0; --lines) {
      Marking& line = markings[take<std::uint32_t>()];
      line.type = take<std::uint8_t>();
      take_f32();
      line.width = take_f32();
      line.x.resize(take<std::uint16_t>());
      line.painted.resize(line.x.size());
      for (float& x : line.x) x = take_f32();
      for (std::size_t i = 0; i < 2 * line.x.size(); ++i) take_f32();
      for (int& painted : line.painted) painted = take<std::uint8_t>();
    }
  }

  void read_curbs() {
    read_gone(curbs);
    for (auto lines = take<std::uint32_t>(); lines > 0; --lines) {
      std::vector<float>& line = curbs[take<std::uint32_t>()];
      take_f32();
      take<std::uint8_t>();
      take<std::uint8_t>();
      line.resize(take<std::uint16_t>());
      for (float& x : line) x = take_f32();
      for (std::size_t i = 0; i < 5 * line.size(); ++i) take_f32();
    }
  }

  std::span<const std::uint8_t> bytes_;
};

}  // namespace curbstone::viewer
