#pragma once

#include <curbstone/map_points_t.hpp>
#include <curbstone/voted_points_t.hpp>

#include "common/tiles/tile.hpp"

namespace curbstone::viewer {

/// Records first, first + 1, ... of a tile: record k is a point in a voxel of its own, x from 60 steps on, 60 apart.
inline map_points_t records(TileKey key, int first, int count, std::int32_t epoch = 3) {
  map_points_t message{};
  message.epoch = epoch;
  message.tile_x = key.x;
  message.tile_y = key.y;
  message.z_origin = 1;
  message.first = first;
  message.num_points = count;
  for (int k = first; k < first + count; ++k) {
    message.x.push_back(static_cast<std::int16_t>(60 * (1 + k % 20)));
    message.y.push_back(static_cast<std::int16_t>(60 * (k / 20 % 25)));
    message.z.push_back(static_cast<std::int16_t>(60 * (k / 500) - 250));
    message.intensity.push_back(static_cast<std::uint8_t>(k % 200));
  }
  return message;
}

/// The same points as a step of VOTED_POINTS, each with a tensor of its own.
inline voted_points_t voted(TileKey key, int first, int count, std::int32_t base, std::int32_t revision,
                            std::uint8_t stick = 100, std::uint8_t plate = 30) {
  const map_points_t points = records(key, first, count);
  voted_points_t message{};
  message.epoch = points.epoch;
  message.tile_x = key.x;
  message.tile_y = key.y;
  message.z_origin = 1;
  message.chain = 5;
  message.base = base;
  message.revision = revision;
  message.num_pages = 1;
  message.total = first + count;
  message.first = first;
  message.num_points = count;
  message.x = points.x;
  message.y = points.y;
  message.z = points.z;
  message.intensity = points.intensity;
  message.num_scales = 2;
  message.sigma = {0.1F, 0.3F};
  message.num_voters = 2 * count;
  for (int scale = 0; scale < 2; ++scale) {
    for (int k = first; k < first + count; ++k) message.voter.push_back(k);
  }
  for (int scale = 0; scale < 2; ++scale) {
    for (int k = first; k < first + count; ++k) {
      message.scale.push_back(static_cast<std::uint8_t>(scale));
      message.point.push_back(k);
      for (auto* list : {&message.normal_x, &message.normal_y, &message.normal_z}) list->push_back(0);
      for (auto* list : {&message.tangent_x, &message.tangent_y, &message.tangent_z}) list->push_back(0);
      message.stick.push_back(scale == 1 ? stick : 250);
      message.plate.push_back(scale == 1 ? plate : 250);
      message.mass.push_back(1);
    }
  }
  message.num_tensors = 2 * count;
  return message;
}

}  // namespace curbstone::viewer
