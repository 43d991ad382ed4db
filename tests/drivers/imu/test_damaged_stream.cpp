// Each single damage of a line, at each byte of some messages of real recordings: it costs its message, and nothing
// that is wrong goes out.
#include <gtest/gtest.h>

#include <curbstone/imu_t.hpp>
#include <map>
#include <span>

#include "drivers/imu/imu_node.hpp"
#include "tests/drivers/byte_stream.hpp"
#include "tests/drivers/recorder.hpp"
#include "tests/paths.hpp"
#include "tests/stamps.hpp"

namespace curbstone::imu {
namespace {

using test::Bytes;
using test::kStart;

/// Damages a message at a byte.
struct Damage {
  const char* name;
  void (*apply)(Bytes& frame, std::size_t at);
};

constexpr std::array kDamages = {
    Damage{"lost", [](Bytes& f, std::size_t at) { f.erase(f.begin() + static_cast<std::ptrdiff_t>(at)); }},
    Damage{"two lost",
           [](Bytes& f, std::size_t at) {
             const auto begin = f.begin() + static_cast<std::ptrdiff_t>(at);
             f.erase(begin, begin + std::min<std::ptrdiff_t>(2, f.end() - begin));
           }},
    Damage{"the rest lost", [](Bytes& f, std::size_t at) { f.resize(at); }},
    Damage{"doubled", [](Bytes& f, std::size_t at) { f.insert(f.begin() + static_cast<std::ptrdiff_t>(at), f[at]); }},
    Damage{"a preamble more",
           [](Bytes& f, std::size_t at) { f.insert(f.begin() + static_cast<std::ptrdiff_t>(at), 0xFA); }},
    Damage{"lowest bit", [](Bytes& f, std::size_t at) { f[at] ^= 0x01; }},
    Damage{"highest bit", [](Bytes& f, std::size_t at) { f[at] ^= 0x80; }},
    Damage{"ones", [](Bytes& f, std::size_t at) { f[at] = 0xFF; }},
};

class DamagedStream : public ::testing::TestWithParam<int> {
 protected:
  struct Played {
    std::map<std::int64_t, imu_t> messages;  // by stamp
    std::size_t published = 0;
    NodeReport report;
  };
  static Played play(const std::vector<Bytes>& frames) {
    test::Recorder<imu_t> recorder("IMU");
    ImuNode node(ImuConfig{.configure = false}, recorder.bus());
    std::int64_t now = kStart;
    for (const Bytes& frame : frames) {
      node.on_bytes(now, frame);
      node.tick(now += 10'000);
    }
    node.finish();
    Played played;
    played.published = recorder.messages().size();
    for (const imu_t& message : recorder.messages()) played.messages[message.utime] = message;
    played.report = node.report();
    return played;
  }
  /// A message of the same length, with the right sum: nothing can tell that it is damaged.
  static bool has_valid_sum(const Bytes& frame) {
    if (frame.size() < 5 || frame.size() < frame[3] + std::size_t{5} || frame[0] != 0xFA) return false;
    std::uint8_t sum = 0;
    for (std::size_t i = 1; i < frame[3] + std::size_t{5}; ++i) sum = static_cast<std::uint8_t>(sum + frame[i]);
    return sum == 0;
  }
  static bool equal(const imu_t& a, const imu_t& b) {
    return std::ranges::equal(a.acceleration, b.acceleration) && std::ranges::equal(a.angular_rate, b.angular_rate) &&
           a.status == b.status && a.sequence == b.sequence;
  }
};

TEST_P(DamagedStream, CostsItsMessageAndNothingWrongGoesOut) {
  const std::string file = test::data_path("imu_xsens/" + std::to_string(GetParam()) + ".output.bin");
  const Bytes bytes = test::read_bytes(file);
  if (bytes.empty()) GTEST_SKIP() << file << " is not there";
  std::vector<Bytes> frames;
  for (std::span<const std::uint8_t> rest = bytes; !rest.empty() && frames.size() < 70;
       rest = rest.subspan(rest[3] + std::size_t{5})) {
    const auto frame = rest.first(rest[3] + std::size_t{5});
    if (frame[4] == 0x10) frames.emplace_back(frame.begin(), frame.end());
  }
  const Played whole = play(frames);
  ASSERT_GT(whole.published, 60U);
  int lost = 0, runs = 0, unnamed = 0, by_chance = 0;
  for (const std::size_t index : {50u, 51u}) {
    for (std::size_t at = 0; at < frames[index].size(); ++at) {
      for (const Damage& damage : kDamages) {
        const auto where = ::testing::Message() << damage.name << " at byte " << at << " of message " << index;
        std::vector<Bytes> damaged = frames;
        damage.apply(damaged[index], at);
        if (damaged[index] == frames[index]) continue;
        const Played played = play(damaged);
        ++runs;
        lost += static_cast<int>(whole.published - played.published);
        ASSERT_GE(played.published + 2, whole.published) << where;
        std::int64_t named = 0;
        for (const auto& [name, value] : played.report.counters.values())
          if (name.starts_with("refused.") || name == "lost.packets") named += value;
        if (played.published < whole.published && named == 0) ++unnamed;
        for (const auto& [utime, message] : played.messages) {
          const auto same = whole.messages.find(utime);
          ASSERT_TRUE(same != whole.messages.end()) << where << ": a stamp that was none, " << utime - kStart;
          if (equal(message, same->second)) continue;
          ASSERT_TRUE(has_valid_sum(damaged[index])) << where << ", stamp " << utime - kStart;
          ++by_chance;
        }
      }
    }
  }
  EXPECT_EQ(unnamed, 0);
  EXPECT_LE(by_chance, runs / 1000) << "a sum of eight bits cannot exclude it";
  std::printf("[ figure ] %d damages cost %d samples; %d have the right sum by chance\n", runs, lost, by_chance);
}
INSTANTIATE_TEST_SUITE_P(Files, DamagedStream, ::testing::Range(1, 5));

}  // namespace
}  // namespace curbstone::imu
