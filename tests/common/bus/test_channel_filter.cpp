#include "common/bus/socket/channel_filter.hpp"

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace curbstone {
namespace {

/// A socket with the filter, and one that sends to it.
class Filtered {
 public:
  explicit Filtered(const std::vector<std::string>& channels) : Filtered(make_channel_filter(channels)) {}
  explicit Filtered(std::vector<sock_filter> program) {
    const sock_fprog filter{static_cast<unsigned short>(program.size()), program.data()};
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof address;
    auto* const at = reinterpret_cast<sockaddr*>(&address);
    if (bind(in_, at, size) != 0 || getsockname(in_, at, &size) != 0 || connect(out_, at, size) != 0 ||
        setsockopt(in_, SOL_SOCKET, SO_ATTACH_FILTER, &filter, sizeof filter) != 0) {
      throw std::runtime_error("no socket with a filter");
    }
  }
  ~Filtered() {
    close(in_);
    close(out_);
  }
  Filtered(const Filtered&) = delete;
  Filtered& operator=(const Filtered&) = delete;

  /// Over loopback a datagram has arrived, or never will, when send() returns.
  bool passes(const std::string& datagram) const {
    (void)!send(out_, datagram.data(), datagram.size(), 0);
    std::string got(70'000, ' ');
    const ssize_t size = recv(in_, got.data(), got.size(), MSG_DONTWAIT);
    if (size < 0) return false;
    EXPECT_EQ(got.substr(0, static_cast<std::size_t>(size)), datagram) << "all of it";
    return true;
  }

 private:
  int in_ = socket(AF_INET, SOCK_DGRAM, 0);
  int out_ = socket(AF_INET, SOCK_DGRAM, 0);
};

using namespace std::string_literals;

std::string short_message(const std::string& channel, const std::string& data) {
  return "LC02\0\0\1\2"s + channel + '\0' + data;
}

std::string fragment(int number, const std::string& channel_and_data) {
  return "LC03\0\0\1\2\0\0\x20\0\0\0\0\0\0"s + static_cast<char>(number) + "\0\2"s + channel_and_data;
}

TEST(ChannelFilter, PassesItsChannelsAndNoOthers) {
  const Filtered socket({"MAP_POSE", "IMU", "WHEELS"});
  const std::string data(40, 'x');
  for (const char* channel : {"IMU", "WHEELS", "MAP_POSE"}) {
    EXPECT_TRUE(socket.passes(short_message(channel, data))) << channel;
  }
  for (const char* channel : {"", "I", "IM", "IMU2", "IMV", "WHEEL", "WHEELS_", "MAP_POINTS", "MAP_POSE2", "imu"}) {
    EXPECT_FALSE(socket.passes(short_message(channel, data))) << channel;
  }
}

TEST(ChannelFilter, PassesTheShortestMessageOnTheShortestChannel) {
  const Filtered socket({"A_LONG_NAME_OF_A_CHANNEL", "A", "ABCDE"});
  EXPECT_TRUE(socket.passes(short_message("A", "")));
  EXPECT_TRUE(socket.passes(short_message("ABCDE", "")));
  EXPECT_FALSE(socket.passes(short_message("B", "")));
}

TEST(ChannelFilter, TurnsAwayFragmentsAndWhatIsNotLcms) {
  const Filtered one({"IMU"});
  const Filtered any(make_message_filter());
  for (const Filtered* socket : {&one, &any}) {
    EXPECT_FALSE(socket->passes(fragment(0, "IMU\0data"s)));
    EXPECT_FALSE(socket->passes(fragment(1, "of whatever channel")));
    EXPECT_FALSE(socket->passes("something else"));
    EXPECT_FALSE(socket->passes(""));
  }
}

TEST(MessageFilter, PassesWholeMessagesOnAnyChannel) {
  const Filtered socket(make_message_filter());
  for (const std::size_t size : {1U, 2U, 40U, 62U, 63U}) {
    EXPECT_TRUE(socket.passes(short_message(std::string(size, 'A'), ""))) << size;
    EXPECT_TRUE(socket.passes(short_message(std::string(size, 'A'), std::string(60'000, 'x')))) << size;
  }
}

TEST(MessageFilter, TurnsAwayNamesThatAreEmptyTooLongOrDoNotEnd) {
  const Filtered socket(make_message_filter());
  EXPECT_FALSE(socket.passes(short_message("", "data")));
  EXPECT_FALSE(socket.passes(short_message(std::string(64, 'A'), "data")));
  for (const std::size_t size : {0U, 1U, 30U, 63U, 64U, 1000U})
    EXPECT_FALSE(socket.passes("LC02\0\0\1\2"s + std::string(size, 'A'))) << size;
}

TEST(ChannelFilter, ATruncatedMessageDoesNoHarm) {
  const Filtered socket({"IMU"});
  const std::string whole = short_message("IMU", "");
  for (std::size_t size = 4; size + 1 < whole.size(); ++size)
    EXPECT_FALSE(socket.passes(whole.substr(0, size))) << size;
}

TEST(ChannelFilter, WithoutChannelsNoMessagePasses) {
  EXPECT_FALSE(Filtered(std::vector<std::string>{}).passes(short_message("IMU", "x")));
}

}  // namespace
}  // namespace curbstone
