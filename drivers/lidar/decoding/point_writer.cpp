#include "drivers/lidar/decoding/point_writer.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "drivers/lidar/decoding/direction.hpp"
#include "drivers/lidar/decoding/vector_width.hpp"

namespace curbstone::lidar::decoding {

namespace {

/// State of the head at a block's first shot.
struct HeadOfBlock {
  Direction azimuth;
  double turned_a_second = 0;  ///< deg/s
  double start = 0;            ///< s
  double lens_offset = 0;      ///< m
};

/// Computes the coordinates of the shots' returns. The loop has no branch, and each quantity has its own array, so
/// several points are computed at a time.
CURBSTONE_FOR_EACH_VECTOR_WIDTH
void place_block(const HeadOfBlock& head, const ShotTable& shots, const std::uint16_t* distance, double step, float* x,
                 float* y, float* z, float* time) {
  constexpr double k6th = 1.0 / 6, k12th = 1.0 / 12, k20th = 1.0 / 20, k30th = 1.0 / 30;
  for (std::size_t i = 0; i < kRecordsPerBlock; ++i) {
    const double turned = head.turned_a_second * shots.time[i] * kDegree;
    const double square = turned * turned;
    const double s = turned * (1.0 - square * k6th * (1.0 - square * k20th));
    const double c = 1.0 - square * 0.5 * (1.0 - square * k12th * (1.0 - square * k30th));
    const double cos_head = head.azimuth.cos * c - head.azimuth.sin * s;
    const double sin_head = head.azimuth.sin * c + head.azimuth.cos * s;
    const double cos_beam = cos_head * shots.cos_beside[i] - sin_head * shots.sin_beside[i];
    const double sin_beam = sin_head * shots.cos_beside[i] + cos_head * shots.sin_beside[i];
    const double range = distance[i] * step;
    const double flat = range * shots.cos[i];
    x[i] = static_cast<float>(flat * cos_beam + head.lens_offset * cos_head);
    y[i] = static_cast<float>(-flat * sin_beam - head.lens_offset * sin_head);
    z[i] = static_cast<float>(range * shots.sin[i] + shots.height[i]);
    time[i] = static_cast<float>(head.start + shots.time[i]);
  }
}

/// Selects the returns to publish. Returns the number of shots without one.
CURBSTONE_FOR_EACH_VECTOR_WIDTH
int choose_by_distance(const std::uint16_t* distance, unsigned no_return, unsigned least, unsigned most,
                       std::uint8_t* goes_out) {
  int none = 0;
  for (std::size_t i = 0; i < kRecordsPerBlock; ++i) {
    const unsigned d = distance[i];
    none += static_cast<int>(d == 0) | static_cast<int>(d == no_return);
    goes_out[i] = static_cast<std::uint8_t>(static_cast<int>(d >= least) & static_cast<int>(d <= most));
  }
  return none;
}

/// Packs ring and intensity of each shot into one word, so that both are moved together.
CURBSTONE_FOR_EACH_VECTOR_WIDTH
void mark(const ShotTable& shots, const std::uint8_t* intensity, std::uint32_t* marks) {
  for (std::size_t i = 0; i < kRecordsPerBlock; ++i)
    marks[i] = static_cast<std::uint32_t>(shots.ring[i] << 8 | intensity[i]);
}

CURBSTONE_FOR_EACH_VECTOR_WIDTH
void take_apart(const std::uint32_t* marks, std::size_t count, std::uint8_t* intensity, std::uint8_t* ring) {
  for (std::size_t i = 0; i < count; ++i) intensity[i] = static_cast<std::uint8_t>(marks[i]);
  for (std::size_t i = 0; i < count; ++i) ring[i] = static_cast<std::uint8_t>(marks[i] >> 8);
}

/// Interleaves the first and the other return of each shot, in firing order.
template <class Figures>
void interleave(Figures& figures) {
  const Figures before = figures;
  for (std::size_t i = 0; i < kRecordsPerBlock; ++i) {
    figures[2 * i] = before[i];
    figures[2 * i + 1] = before[kRecordsPerBlock + i];
  }
}

/// The smallest number of steps that is not below `range`, m.
unsigned steps_from(double range, double step) {
  auto steps = static_cast<unsigned>(range / step);
  while (steps > 0 && (steps - 1) * step >= range) --steps;
  while (steps * step < range) ++steps;
  return steps;
}

/// The largest number of steps that is not beyond `range`, m.
unsigned steps_to(double range, double step) {
  auto steps = static_cast<unsigned>(range / step);
  while (steps * step > range) --steps;
  while ((steps + 1) * step <= range) ++steps;
  return steps;
}

template <class Value>
void resize_to_most(std::vector<Value>& values) {
  values.resize(PointWriter::kMaxPoints + kCompactionSlack);
}

}  // namespace

PointWriter::PointWriter(std::shared_ptr<const PointRules> rules, DecodedPacket& packet)
    : rules_(*rules),
      whole_turn_(std::fmod(rules_.limits.end_angle - rules_.limits.start_angle, 360.0) == 0.0),
      least_(std::max(1U, steps_from(rules_.limits.min_range, rules_.unit.step))),
      most_(std::min(rules_.unit.no_return == 0 ? 0xFFFFU : rules_.unit.no_return - 1U,
                     steps_to(rules_.limits.max_range, rules_.unit.step))),
      packet_(packet) {
  packet.fired.rules = std::move(rules);
  packet.fired.places.clear();
  packet.fired.records.clear();
  for (auto* values : {&packet.x, &packet.y, &packet.z, &packet.time_offset}) resize_to_most(*values);
  for (auto* values : {&packet.intensity, &packet.ring}) resize_to_most(*values);
}

void PointWriter::add(const BlockPlace& place, std::span<const BlockRecords> returns) {
  const std::size_t records = returns.size() * kRecordsPerBlock;
  packet_.fired.places.push_back(place);
  packet_.fired.records.insert(packet_.fired.records.end(), returns.begin(), returns.end());
  place_all(place, returns);
  choose(returns);
  if (!whole_turn_) leave_out_sector(place, records);
  if (returns.size() == 2) put_returns_side_by_side();
  const std::array<Column, 5> columns = {Column{x_.data(), packet_.x.data() + count_},
                                         {y_.data(), packet_.y.data() + count_},
                                         {z_.data(), packet_.z.data() + count_},
                                         {time_.data(), packet_.time_offset.data() + count_},
                                         {mark_.data(), marks_.data() + count_}};
  count_ += compact(std::span(goes_out_).first(records), columns);
}

void PointWriter::place_all(const BlockPlace& place, std::span<const BlockRecords> returns) {
  const HeadOfBlock head = {direction_of(place.azimuth), place.turned_a_second, place.start, rules_.lens_offset};
  for (std::size_t i = 0; i < returns.size(); ++i) {
    const std::size_t first = i * kRecordsPerBlock;
    place_block(head, rules_.shots, returns[i].distance.data(), rules_.unit.step, &x_[first], &y_[first], &z_[first],
                &time_[first]);
    mark(rules_.shots, returns[i].intensity.data(), &mark_[first]);
  }
}

void PointWriter::choose(std::span<const BlockRecords> returns) {
  for (std::size_t i = 0; i < returns.size(); ++i) {
    std::uint8_t* goes_out = &goes_out_[i * kRecordsPerBlock];
    const int none = choose_by_distance(returns[i].distance.data(), rules_.unit.no_return, least_, most_, goes_out);
    const int out = std::accumulate(goes_out, goes_out + kRecordsPerBlock, 0);
    packet_.no_return += none - returns[i].repeats;
    packet_.out_of_range += static_cast<int>(kRecordsPerBlock) - out - none;
  }
}

void PointWriter::leave_out_sector(const BlockPlace& place, std::size_t records) {
  for (std::size_t i = 0; i < records; ++i) {
    const std::size_t record = i % kRecordsPerBlock;
    const double azimuth =
        0.01 * place.azimuth + place.turned_a_second * rules_.shots.time[record] + rules_.shots.azimuth[record];
    if (!in_sector(azimuth)) goes_out_[i] = 0;
  }
}

void PointWriter::put_returns_side_by_side() {
  for (auto* figures : {&x_, &y_, &z_, &time_}) interleave(*figures);
  interleave(mark_);
  interleave(goes_out_);
}

void PointWriter::finish() {
  take_apart(marks_.data(), count_, packet_.intensity.data(), packet_.ring.data());
  for (auto* values : {&packet_.x, &packet_.y, &packet_.z, &packet_.time_offset}) values->resize(count_);
  for (auto* values : {&packet_.intensity, &packet_.ring}) values->resize(count_);
}

bool PointWriter::in_sector(double azimuth_deg) const {
  const auto turned = [&](double angle) {
    const double from_start = std::fmod(angle - rules_.limits.start_angle, 360.0);
    return from_start < 0 ? from_start + 360.0 : from_start;
  };
  return turned(azimuth_deg) < turned(rules_.limits.end_angle);
}

void make_points(const FiredPacket& fired, DecodedPacket& packet) {
  packet.begin();
  PointWriter writer(fired.rules, packet);
  const std::size_t returns = fired.places.empty() ? 0 : fired.records.size() / fired.places.size();
  for (std::size_t i = 0; i < fired.places.size(); ++i)
    writer.add(fired.places[i], std::span(fired.records).subspan(i * returns, returns));
  writer.finish();
}

}  // namespace curbstone::lidar::decoding
