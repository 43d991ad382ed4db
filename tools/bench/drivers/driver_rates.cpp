#include "tools/bench/drivers/driver_rates.hpp"

#include <benchmark/benchmark.h>

#include <array>
#include <cstring>
#include <span>
#include <stdexcept>

#include "common/bus/bus.hpp"
#include "drivers/encoder/encoder_node.hpp"
#include "drivers/imu/imu_node.hpp"
#include "drivers/lidar/lidar_node.hpp"

namespace curbstone::bench::drivers {

namespace {

/// Discards encoded messages and counts them.
class DeadEnd final : public Publisher {
 public:
  [[nodiscard]] std::int64_t messages() const { return messages_; }

 protected:
  void publish_bytes(const std::string& /*channel*/, const void* data, int /*size*/) override {
    benchmark::DoNotOptimize(data);
    ++messages_;
  }

 private:
  std::int64_t messages_ = 0;
};

template <class Unit>
void copy_each(const std::vector<Unit>& units) {
  std::array<std::uint8_t, 2048> buffer;
  for (const Unit& unit : units) {
    std::memcpy(buffer.data(), unit.bytes.data(), std::min(unit.bytes.size(), buffer.size()));
    benchmark::ClobberMemory();
  }
}

void copy_each(const std::vector<TimedFrame>& frames) {
  encoder::can::CanFrame buffer;
  for (const TimedFrame& frame : frames) {
    std::memcpy(&buffer, &frame.frame, sizeof buffer);
    benchmark::DoNotOptimize(buffer);
  }
}

/// Passes all packets through a driver once. Returns the number of messages it sent.
std::int64_t run_lidar(const LidarPackets& packets) {
  DeadEnd bus;
  lidar::LidarConfig config;
  config.model = packets.model;
  lidar::LidarNode node(config, bus, [] { return true; });
  for (const TimedPacket& info : packets.infos) node.on_packet(packets.points.front().received, 0, info.bytes);
  for (const TimedPacket& packet : packets.points) node.on_packet(packet.received, 0, packet.bytes);
  node.finish();
  return bus.messages();
}

std::int64_t run_imu(imu::Model model, const std::vector<TimedBytes>& stream) {
  DeadEnd bus;
  imu::ImuConfig config;
  config.model = model;
  config.configure = false;
  imu::ImuNode node(config, bus);
  for (const TimedBytes& bytes : stream) node.on_bytes(bytes.received, bytes.bytes);
  node.finish();
  return bus.messages();
}

std::int64_t run_encoder(const std::vector<TimedFrame>& stream) {
  DeadEnd bus;
  encoder::EncoderConfig config;
  config.configure = false;
  encoder::EncoderNode node(config, bus);
  for (const TimedFrame& frame : stream) node.on_frame(frame.received, frame.frame);
  node.finish();
  return bus.messages();
}

double per_second(std::size_t units, const timing::TurnTimes& times) {
  return static_cast<double>(units) / (times.cpu_ms * 1e-3);
}

template <class Unit>
double pace_of(const std::vector<Unit>& stream) {
  return static_cast<double>(stream.size() - 1) * 1e6 /
         static_cast<double>(stream.back().received - stream.front().received);
}

/// A driver without output would look fast, but its time would be meaningless.
void expect_messages(const std::string& name, std::int64_t messages) {
  if (messages == 0) throw std::runtime_error(name + ": the driver made no message of it");
}

}  // namespace

LidarRate measure(const LidarPackets& packets, const timing::TurnOptions& turns) {
  const auto model = lidar::models::make_model(packets.model, {});
  for (const TimedPacket& info : packets.infos) (void)model->read_info(info.received, info.bytes);
  lidar::decoding::DecodedPacket decoded;
  std::size_t points = 0;
  const auto decode_all = [&] {
    points = 0;
    for (const TimedPacket& packet : packets.points) {
      if (model->decode(packet.received, packet.bytes, decoded) == lidar::decoding::Refusal::kNone)
        points += decoded.x.size();
      benchmark::ClobberMemory();
    }
  };
  decode_all();
  if (points == 0) throw std::runtime_error(packets.name + ": no packet gives points");
  expect_messages(packets.name, run_lidar(packets));
  const std::vector<timing::Contender> contenders = {{"decode", decode_all},
                                                     {"driver", [&] { (void)run_lidar(packets); }},
                                                     {"memcpy", [&] { copy_each(packets.points); }}};
  const std::vector<timing::TurnTimes> times = time_in_turn(contenders, turns);
  const std::size_t count = packets.points.size();
  return {packets.name,
          packets.pace(),
          static_cast<double>(points) / static_cast<double>(count),
          per_second(count, times[0]),
          per_second(count, times[1]),
          per_second(count, times[2])};
}

StreamRate measure(const std::string& name, imu::Model model, const std::vector<TimedBytes>& stream,
                   const timing::TurnOptions& turns) {
  expect_messages(name, run_imu(model, stream));
  std::size_t bytes = 0;
  for (const TimedBytes& unit : stream) bytes += unit.bytes.size();
  const std::vector<timing::Contender> contenders = {{"driver", [&] { (void)run_imu(model, stream); }},
                                                     {"memcpy", [&] { copy_each(stream); }}};
  const std::vector<timing::TurnTimes> times = time_in_turn(contenders, turns);
  return {name, pace_of(stream), static_cast<double>(bytes) / static_cast<double>(stream.size()),
          per_second(stream.size(), times[0]), per_second(stream.size(), times[1])};
}

StreamRate measure(const std::string& name, const std::vector<TimedFrame>& stream, const timing::TurnOptions& turns) {
  expect_messages(name, run_encoder(stream));
  const std::vector<timing::Contender> contenders = {{"driver", [&] { (void)run_encoder(stream); }},
                                                     {"memcpy", [&] { copy_each(stream); }}};
  const std::vector<timing::TurnTimes> times = time_in_turn(contenders, turns);
  return {name, pace_of(stream), sizeof(encoder::can::CanFrame), per_second(stream.size(), times[0]),
          per_second(stream.size(), times[1])};
}

}  // namespace curbstone::bench::drivers
