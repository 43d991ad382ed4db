#include "tools/lidar_tool/watch.hpp"

#include <gmock/gmock.h>

#include "tests/drivers/lidar/packets.hpp"
#include "tests/stamps.hpp"

namespace curbstone::lidar_tool {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

using test::kStart;
constexpr lidar::sources::Ipv4 kDevice = 0xC0A801C8;

/// A second and a half of an RS16, received 2 ms after its first shot; a fault at packets 100 to 109.
enum class Fault { kNone, kLost, kDamaged };
std::vector<std::string> lines_of(Fault fault) {
  Watch watch;
  std::vector<std::string> lines;
  const auto packets = lidar::drive_packets(kStart, 1126);
  for (std::size_t i = 0; i < packets.size(); ++i) {
    const std::int64_t received = kStart + static_cast<std::int64_t>(i) * 1332 + 2000;
    for (std::string& line : watch.on_time(received)) lines.push_back(std::move(line));
    auto bytes = packets[i];
    const bool hit = i >= 100 && i < 110;
    if (hit && fault == Fault::kLost) continue;
    if (hit && fault == Fault::kDamaged) bytes[42] = 0;
    watch.on_packet({received, kDevice, 6699, bytes});
  }
  return lines;
}

TEST(LidarWatch, SaysEachSecondThatASensorIsSane) {
  EXPECT_THAT(
      lines_of(Fault::kNone),
      ElementsAre(AllOf(HasSubstr("192.168.1.200  rs16  751 packets  1200 rpm  clock -2.0 ms"), HasSubstr("ok"))));
}

TEST(LidarWatch, SaysWhatIsLost) {
  EXPECT_THAT(lines_of(Fault::kLost), ElementsAre(HasSubstr("10 LOST")));
}

TEST(LidarWatch, SaysWhatIsRefused) {
  EXPECT_THAT(lines_of(Fault::kDamaged), ElementsAre(HasSubstr("10 REFUSED")));
}

TEST(LidarWatch, SaysThatASensorFellSilentOrWasNeverThere) {
  Watch watch;
  EXPECT_THAT(watch.on_time(kStart), IsEmpty());
  EXPECT_THAT(watch.on_time(kStart + 1'000'000), ElementsAre("nothing comes"));
  watch.on_packet({kStart, kDevice, 6699, lidar::drive_packets(kStart, 1)[0]});
  EXPECT_THAT(watch.on_time(kStart + 2'000'000), ElementsAre(HasSubstr("  1 packets")));
  EXPECT_THAT(watch.on_time(kStart + 3'000'000), ElementsAre(HasSubstr("SILENT")));
}

TEST(LidarWatch, NamesWhoSendsSomethingElse) {
  Watch watch;
  (void)watch.on_time(kStart);
  const std::vector<std::uint8_t> noise(100);
  watch.on_packet({kStart, kDevice, 6699, noise});
  EXPECT_THAT(watch.on_time(kStart + 1'000'000), ElementsAre("192.168.1.200  an unknown device  1 packets: not read"));
}

}  // namespace
}  // namespace curbstone::lidar_tool
