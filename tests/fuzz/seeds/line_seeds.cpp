// What comes by serial lines and CAN: IMUs, encoders.
#include "drivers/encoder/can/slcan.hpp"
#include "drivers/encoder/canopen/canopen.hpp"
#include "tests/fuzz/seeds/seed_folder.hpp"
#include "tools/simulate/devices/can_drive_emulator.hpp"
#include "tools/simulate/devices/wit_emulator.hpp"
#include "tools/simulate/devices/xsens_emulator.hpp"

namespace curbstone::fuzz {
namespace {

constexpr int kSamples = 20;
/// With noise: a sensor without is refused as stuck.
simulate::devices::XsensSample at_rest(int index) {
  const double noise = 0.01 * (index % 2);
  return {.acceleration = {0.1 + noise, 0.2 + noise, 9.8 + noise},
          .angular_rate = {0.01 + noise, 0.02, 0.03},
          .orientation = std::array<double, 4>{1, 0, 0, 0}};
}

void put_timed(Seed& seed, std::int64_t after, std::span<const std::uint8_t> bytes) {
  put(seed, static_cast<std::uint16_t>(after / 10));
  put_piece(seed, bytes);
}

Seed xsens() {
  simulate::devices::XsensEmulator::Settings settings;
  settings.configured = true;
  simulate::devices::XsensEmulator device(settings);
  Seed seed;
  std::int64_t now = 1'000'000;  // us
  put_timed(seed, 0, device.power_on(now));
  now += 600'000;  // it measures by then, unless somebody answers
  for (int i = 0; i < kSamples; ++i, now += 10'000) put_timed(seed, 10'000, device.sample(now, at_rest(i)));
  return seed;
}

Seed witmotion() {
  simulate::devices::WitEmulator device;
  Seed seed;
  std::int64_t now = 1'000'000;  // us
  device.power_on(now);
  for (int i = 0; i < kSamples; ++i, now += 100'000) put_timed(seed, 100'000, device.sample(now, at_rest(i)));
  return seed;
}

/// What a drive sends after it was started without further settings, and what a master hears from one that is set up.
std::vector<std::pair<std::int64_t, encoder::can::CanFrame>> drive() {
  using encoder::can::CanFrame;
  std::vector<std::pair<std::int64_t, CanFrame>> frames;
  simulate::devices::CanDriveEmulator device;
  for (const CanFrame& frame : device.power_on(1'000'000)) frames.push_back({0, frame});
  for (int i = 0; i < kSamples; ++i) {
    const auto low = static_cast<std::uint8_t>(10 * i);
    frames.push_back({10'000, CanFrame::make(encoder::canopen::kTpdo1 + 1, {low, 1, 0, 0, low, 2, 0, 0})});
    frames.push_back({100, CanFrame::make(encoder::canopen::kTpdo2 + 1, {0x27, 0, 0x27, 0, low, 0, low, 0})});
  }
  for (const CanFrame& frame : device.set_faults(2, 0)) frames.push_back({1000, frame});
  frames.push_back({1000, CanFrame::make(encoder::canopen::kHeartbeat + 1, {0x05})});
  return frames;
}

Seed canopen(std::uint8_t choice) {
  Seed seed = {choice};
  for (const auto& [after, frame] : drive()) {
    put(seed, static_cast<std::uint16_t>(after / 10));
    put(seed, frame.id);
    put(seed, static_cast<std::uint8_t>(frame.size | (frame.extended ? 16 : 0) | (frame.remote ? 32 : 0)));
    put(seed, frame.data);
  }
  return seed;
}

Seed slcan() {
  Seed seed;
  for (int i = 0; i < 5; ++i) put_timed(seed, 50'000, bytes_of("\r"));  // answers to the commands that open it
  for (const auto& [after, frame] : drive()) put_timed(seed, after, encoder::can::encode_slcan(frame));
  put_timed(seed, 1000, bytes_of("F80\r\a"));
  put_timed(seed, 1000, bytes_of("T12345678211223344\rr1230\r"));
  return seed;
}

Seed modbus() {
  Seed seed;
  for (int i = 0; i < 30; ++i) {
    put(seed, std::uint16_t{0});  // good, no exception
    put(seed, std::uint16_t{2000});
    for (int k = 0; k < 8; ++k) put(seed, static_cast<std::uint16_t>(k < 2 ? 0 : i * (k % 2)));
  }
  return seed;
}

}  // namespace

void write_line_seeds(const SeedFolder& folder) {
  folder.write("xsens", "emulated", xsens());
  folder.write("witmotion", "emulated", witmotion());
  for (const int number : {1, 2, 3, 4, 5}) {
    const Seed bytes = SeedFolder::read(folder.recording("imu_xsens/" + std::to_string(number) + ".output.bin"), 4096);
    Seed seed;
    for (std::size_t at = 0; at + 64 <= bytes.size(); at += 64) put_timed(seed, 5000, std::span(bytes).subspan(at, 64));
    if (!seed.empty()) folder.write("xsens", "recorded_" + std::to_string(number), seed);
  }
  for (const std::uint8_t choice : {std::uint8_t{0}, std::uint8_t{1}, std::uint8_t{3}})
    folder.write("canopen", "drive_" + std::to_string(choice), canopen(choice));
  folder.write("slcan", "drive", slcan());
  folder.write("modbus", "drive", modbus());
}

}  // namespace curbstone::fuzz
