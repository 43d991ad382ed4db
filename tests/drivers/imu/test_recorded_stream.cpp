#include <gtest/gtest.h>

#include <curbstone/imu_t.hpp>
#include <span>

#include "drivers/imu/imu_node.hpp"
#include "tests/drivers/byte_stream.hpp"
#include "tests/drivers/recorder.hpp"
#include "tests/paths.hpp"
#include "tests/stamps.hpp"

namespace curbstone::imu {
namespace {

using test::kStart;

/// A recording of an Xsens with a GNSS receiver, a message at a time, at the pace of the device.
class RecordedStream : public ::testing::Test {
 protected:
  void SetUp() override {
    const std::string file = test::data_path("imu_xsens/1.output.bin");
    const test::Bytes bytes = test::read_bytes(file);
    if (bytes.empty()) GTEST_SKIP() << file << " is not there";
    for (std::span<const std::uint8_t> rest = bytes; !rest.empty(); rest = rest.subspan(rest[3] + std::size_t{5})) {
      frames_.emplace_back(rest.begin(), rest.begin() + rest[3] + 5);
    }
    ImuConfig config;
    config.configure = false;
    node_ = std::make_unique<ImuNode>(config, recorder_.bus(), [](std::span<const std::uint8_t>) {});
  }
  static bool has_inertia(const test::Bytes& frame) { return frame[4] == 0x10; }  // its first item is the counter
  /// The bytes of item `id` in a frame.
  static std::span<std::uint8_t> item(test::Bytes& frame, unsigned id) {
    for (std::size_t at = 4; at + 3 < frame.size(); at += frame[at + 2] + std::size_t{3}) {
      if ((frame[at] << 8 | frame[at + 1]) == static_cast<int>(id))
        return std::span(frame).subspan(at + 3, frame[at + 2]);
    }
    return {};
  }
  static void add_to(std::span<std::uint8_t> number, std::int64_t difference) {
    std::int64_t value = difference;
    for (const std::uint8_t& byte : number) value += std::int64_t{byte} << (8 * (&number.back() - &byte));
    for (auto& byte : number) byte = static_cast<std::uint8_t>(value >> (8 * (&number.back() - &byte)));
  }
  static void seal(test::Bytes& frame) {
    std::uint8_t sum = 0;
    for (std::size_t i = 1; i + 1 < frame.size(); ++i) sum = static_cast<std::uint8_t>(sum + frame[i]);
    frame.back() = static_cast<std::uint8_t>(-sum);
  }
  /// The recording `times` times in a row, as one drive: counter and time go on.
  std::vector<test::Bytes> drive(int times) {
    std::vector<test::Bytes> all;
    for (int k = 0; k < times; ++k) {
      for (test::Bytes frame : frames_) {
        add_to(item(frame, 0x1020), 100 * k);
        add_to(item(frame, 0x1060), 9600 * k);
        seal(frame);
        all.push_back(std::move(frame));
      }
    }
    return all;
  }
  /// Each message is received when a sample with the right time would have been taken.
  void play(const std::vector<test::Bytes>& frames) {
    for (const test::Bytes& frame : frames) {
      if (has_inertia(frame)) now_ += 10'000;
      node_->on_bytes(now_, frame);
    }
    node_->finish();
  }
  void expect_even_stamps(std::size_t samples) {
    ASSERT_EQ(messages().size(), samples);
    for (const imu_t& message : messages()) EXPECT_EQ((message.utime - kStart) % 10'000, 0) << message.sequence;
  }

  const std::vector<imu_t>& messages() { return recorder_.messages(); }
  std::int64_t count(std::string_view name) const { return node_->report().counters[name]; }

  test::Recorder<imu_t> recorder_{"IMU"};
  std::unique_ptr<ImuNode> node_;
  std::int64_t now_ = kStart;
  std::vector<test::Bytes> frames_;
};

TEST_F(RecordedStream, IsPublishedWhole) {
  play(frames_);
  EXPECT_EQ(count("frames"), 100);
  EXPECT_EQ(count("skipped.incomplete"), 4);  // of its GNSS receiver
  EXPECT_EQ(count("lost.packets"), 0);
  EXPECT_EQ(count("clock_restarts"), 0);
  EXPECT_EQ(messages().size(), 96u);
  for (std::size_t i = 0; i < messages().size(); ++i) EXPECT_EQ(messages()[i].sequence, static_cast<int>(i));
}

class GnssMessagesThatAreOld : public RecordedStream, public ::testing::WithParamInterface<int> {};

TEST_P(GnssMessagesThatAreOld, NeverTouchTheClock) {
  auto frames = drive(48);
  for (auto& frame : frames) {
    if (has_inertia(frame)) continue;
    add_to(item(frame, 0x1060), -GetParam());
    seal(frame);
  }
  play(frames);
  EXPECT_EQ(count("clock_restarts"), 0);
  EXPECT_EQ(count("lost.packets"), 0);
  EXPECT_EQ(count("refused.time"), 0);
  EXPECT_EQ(count("skipped.incomplete"), 48 * 4);
  expect_even_stamps(48u * 96);
}
INSTANTIATE_TEST_SUITE_P(Ticks, GnssMessagesThatAreOld, ::testing::Values(0, 100, 25'000, 1'000'000));

TEST_F(RecordedStream, SamplesThatAreLostBesideAGnssMessageAreCounted) {
  auto frames = drive(48);
  std::vector<test::Bytes> left;
  int removed = 0;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const bool beside = i > 0 && !has_inertia(frames[i - 1]);
    removed += beside ? 1 : 0;
    if (!beside) left.push_back(frames[i]);
  }
  play(left);
  EXPECT_EQ(removed, 48 * 4);
  EXPECT_EQ(count("lost.packets"), removed);
  EXPECT_EQ(count("samples"), 48 * 96 - removed);
  EXPECT_EQ(messages().back().sequence, 48 * 96 - 1);
}

TEST_F(RecordedStream, ALostGnssMessageIsNoGapInTheSamples) {
  auto frames = drive(2);
  std::erase_if(frames, [](const test::Bytes& frame) { return !has_inertia(frame); });
  play(frames);
  EXPECT_EQ(count("lost.packets"), 8);
  EXPECT_EQ(messages().back().sequence, 2 * 96 - 1);
}

class SampleTimesThatAreWrong : public RecordedStream, public ::testing::WithParamInterface<int> {};

TEST_P(SampleTimesThatAreWrong, CostTheirSamplesAndMoveNoStamp) {
  auto frames = drive(5);
  int wrong = 0;
  for (std::size_t i = 20; i + 2 < frames.size(); i += 50) {
    if (!has_inertia(frames[i])) continue;
    add_to(item(frames[i], 0x1060), GetParam());
    seal(frames[i]);
    ++wrong;
  }
  play(frames);
  EXPECT_EQ(count("refused.time"), wrong);
  EXPECT_EQ(count("clock_restarts"), 0);
  EXPECT_EQ(count("lost.packets"), 0);
  expect_even_stamps(static_cast<std::size_t>(5 * 96 - wrong));
  EXPECT_EQ(messages().back().sequence, 5 * 96 - 1) << "the gap shows what is missing";
}
INSTANTIATE_TEST_SUITE_P(Ticks, SampleTimesThatAreWrong,
                         ::testing::Values(20'000, -20'000, 36'000'000, -36'000'000, 8, -8, 64, -64));

TEST_F(RecordedStream, SwappedNeighboursCostTheLaterOneAndAreNotLostToo) {
  auto frames = drive(2);
  for (const std::size_t i : {20u, 30u, 31u, 60u, 150u}) std::swap(frames[i], frames[i + 1]);
  play(frames);
  EXPECT_EQ(count("lost.packets"), 0);
  EXPECT_EQ(count("refused.time"), 0);
  EXPECT_EQ(count("clock_restarts"), 0);
  EXPECT_GE(count("refused.late"), 4);
  EXPECT_EQ(messages().size() + static_cast<std::size_t>(count("refused.late")), 2u * 96);
  EXPECT_EQ(messages().back().sequence, 2 * 96 - 1);
}

TEST_F(RecordedStream, AMessageThatComesTwiceIsUsedOnce) {
  auto frames = drive(1);
  frames.insert(frames.begin() + 50, frames[50]);
  frames.insert(frames.begin() + 10, frames[10]);
  play(frames);
  EXPECT_EQ(count("refused.repeated"), 2);
  EXPECT_EQ(count("lost.packets"), 0);
  EXPECT_EQ(messages().size(), 96u);
}

}  // namespace
}  // namespace curbstone::imu
