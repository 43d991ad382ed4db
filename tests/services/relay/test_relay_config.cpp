#include "services/relay/relay_config.hpp"

#include <arpa/inet.h>
#include <gtest/gtest.h>

#include <stdexcept>

namespace curbstone::relay {
namespace {

std::vector<sockaddr_in> addresses(const std::string& peers) {
  RelayConfig config;
  config.peers = peers;
  return peer_addresses(config);
}

TEST(RelayConfig, PeersAreAddressesWithOrWithoutAPort) {
  const auto peers = addresses("192.168.2.1, 192.168.2.2:7721");
  ASSERT_EQ(peers.size(), 2U);
  EXPECT_EQ(peers[0].sin_addr.s_addr, inet_addr("192.168.2.1"));
  EXPECT_EQ(ntohs(peers[0].sin_port), 7720);
  EXPECT_EQ(ntohs(peers[1].sin_port), 7721);
}

TEST(RelayConfig, RefusesWhatIsNoPeer) {
  for (const char* peers : {"", ",", "second-host", "192.168.2", "192.168.2.2:", "192.168.2.2:0", "192.168.2.2:99999",
                            "192.168.2.2:77x", "::1"}) {
    EXPECT_THROW((void)addresses(peers), std::invalid_argument) << peers;
  }
}

}  // namespace
}  // namespace curbstone::relay
