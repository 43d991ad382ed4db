#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <utility>

#include "services/viewer/frames/byte_writer.hpp"
#include "services/viewer/store/dense_cloud.hpp"

namespace curbstone::viewer::frames {

/// What a page wants of the dense cloud.
struct CloudWish {
  bool wide = false;                                  ///< all that is kept around the vehicle
  bool saliency = false;                              ///< with the saliencies
  std::optional<std::pair<double, double>> cut = {};  ///< m in map: the tiles of a cross-section there
  [[nodiscard]] bool any() const { return wide || cut.has_value(); }
};

/// Sends one page the changes of the dense cloud, within a rate. Pure; one thread.
class CloudFeed {
 public:
  static constexpr double kRate = 200'000;     ///< bytes per second, in the mean
  static constexpr double kMaxBytes = 36'000;  ///< of a frame, about; 4,000 points
  static constexpr std::size_t kPointBytes = 9;

  void want(const CloudWish& wish);
  [[nodiscard]] const CloudWish& wish() const { return wish_; }
  /// The page has nothing.
  void forget() { sent_.clear(); }
  /// Writes tile records (README.md), as many as the rate allows until `now`, us: first those of the cross-section,
  /// then those of which the page lacks the most points, the nearest to the vehicle first. Returns whether it wrote
  /// any.
  bool write(ByteWriter& out, const store::DenseCloud& cloud, std::int64_t now);
  /// Whether write() would write something.
  [[nodiscard]] bool has_news(const store::DenseCloud& cloud) const;

 private:
  [[nodiscard]] bool is_cut(TileKey key) const;
  [[nodiscard]] std::uint64_t sent(TileKey key) const;

  CloudWish wish_;
  std::map<TileKey, std::uint64_t> sent_;  // number up to which the page has the tile
  double allowance_ = kMaxBytes;           // bytes; below 0 after a large tile
  std::int64_t last_ = 0;                  // us
};

}  // namespace curbstone::viewer::frames
