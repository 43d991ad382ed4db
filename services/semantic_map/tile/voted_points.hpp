#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "common/tiles/vector_memory.hpp"

namespace curbstone::semantic_map::tile {

/// The vote's result for a place, at the coarse scale (0.3 m).
struct VotedTensor {
  Eigen::Vector3f normal = Eigen::Vector3f::UnitZ();  ///< e1, z >= 0
  float stick = 0;                                    ///< (l1 - l2) / l1: surface saliency
  float plate = 0;                                    ///< (l2 - l3) / l1: crease saliency
  float mass = 0;  ///< sum of the votes' weights; 0: no votes, the rest is meaningless
};

/// A point of the dense map with its vote.
struct VotedPoint : VotedTensor {
  float x = 0;  ///< m from the tile's corner, 0 .. kTileSize
  float y = 0;
  float z = 0;  ///< m in map
};

/// The points of a tile. Points that the vote thinned out, some two of three, share the tensor of their voxel's voter,
/// which is stored once.
class VotedPoints {
 public:
  struct Place {
    float x = 0;  ///< as in VotedPoint
    float y = 0;
    float z = 0;
    std::uint32_t tensor = 0;  ///< index into tensors()
  };

  [[nodiscard]] std::size_t size() const { return places_.size(); }
  [[nodiscard]] bool empty() const { return places_.empty(); }
  [[nodiscard]] std::span<const Place> places() const { return places_; }
  /// In the order of the first points that refer to them.
  [[nodiscard]] std::span<const VotedTensor> tensors() const { return tensors_; }
  [[nodiscard]] VotedPoint operator[](std::size_t i) const {
    const Place& at = places_[i];
    return {tensors_[at.tensor], at.x, at.y, at.z};
  }

  void make_room(std::size_t more) { curbstone::make_room(more, places_); }
  /// Adds a point with a tensor of its own.
  void push_back(const VotedPoint& point) {
    const auto own = static_cast<std::uint32_t>(tensors_.size());
    curbstone::make_room(1, tensors_);
    tensors_.push_back(point);
    places_.push_back({point.x, point.y, point.z, own});
  }
  /// Adds a point with an existing tensor.
  void append(const Place& place) { places_.push_back(place); }
  /// Changes the tensor of all points that refer to it.
  void set_tensor(std::uint32_t tensor, const VotedTensor& value) { tensors_[tensor] = value; }
  /// Keeps the first `size` points.
  void shorten(std::size_t size) { places_.resize(std::min(size, places_.size())); }

  class Iterator {
   public:
    Iterator(const VotedPoints& points, std::size_t i) : points_(&points), i_(i) {}
    VotedPoint operator*() const { return (*points_)[i_]; }
    Iterator& operator++() {
      ++i_;
      return *this;
    }
    bool operator==(const Iterator& other) const = default;

   private:
    const VotedPoints* points_;
    std::size_t i_;
  };
  [[nodiscard]] Iterator begin() const { return {*this, 0}; }
  [[nodiscard]] Iterator end() const { return {*this, size()}; }

 private:
  std::vector<Place> places_;
  std::vector<VotedTensor> tensors_;
};

}  // namespace curbstone::semantic_map::tile
