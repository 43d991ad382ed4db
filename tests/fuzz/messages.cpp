// A message of each type from any bytes. What decodes is encoded as the same bytes. Input: type (1 byte), message
// without its fingerprint.
#include <algorithm>
#include <curbstone/curb_lines_t.hpp>
#include <curbstone/imu_t.hpp>
#include <curbstone/lidar_points_t.hpp>
#include <curbstone/map_points_t.hpp>
#include <curbstone/map_pose_t.hpp>
#include <curbstone/map_trajectory_t.hpp>
#include <curbstone/odometry_t.hpp>
#include <curbstone/pose_t.hpp>
#include <curbstone/raw_packet_t.hpp>
#include <curbstone/resend_request_t.hpp>
#include <curbstone/semantic_tile_t.hpp>
#include <curbstone/service_config_t.hpp>
#include <curbstone/service_status_t.hpp>
#include <curbstone/tile_index_t.hpp>
#include <curbstone/tile_request_t.hpp>
#include <curbstone/voted_points_t.hpp>
#include <curbstone/wheels_t.hpp>
#include <procman_lcm/deputy_info_t.hpp>
#include <procman_lcm/discovery_t.hpp>
#include <procman_lcm/orders_t.hpp>
#include <procman_lcm/output_t.hpp>

#include "common/bus/decode.hpp"
#include "common/message_types/field_values.hpp"
#include "tests/fuzz/support/message.hpp"
#include "tests/fuzz/support/require.hpp"

namespace curbstone::fuzz {
namespace {

template <class Message>
void check(Bytes body) {
  const std::vector<std::uint8_t> bytes = with_fingerprint<Message>(body);
  Message message{};
  if (!decode(bytes.data(), static_cast<int>(bytes.size()), message)) return;
  std::vector<std::uint8_t> first(static_cast<std::size_t>(message.getEncodedSize()));
  require(first.size() <= bytes.size(), "no message is larger than its bytes");
  require(message.encode(first.data(), 0, static_cast<int>(first.size())) == static_cast<int>(first.size()),
          "what was decoded can be encoded");
  Message again{};
  require(decode(first.data(), static_cast<int>(first.size()), again), "what was encoded can be decoded");
  std::vector<std::uint8_t> second(static_cast<std::size_t>(again.getEncodedSize()));
  (void)again.encode(second.data(), 0, static_cast<int>(second.size()));
  require(first == second, "a message is encoded as the same bytes");
  require(decode_values(TypeTable::built_in(), first.data(), first.size()).has_value(),
          "what its class decodes has named values");
}

using Check = void (*)(Bytes);
constexpr Check kChecks[] = {check<curb_lines_t>,
                             check<imu_t>,
                             check<lidar_points_t>,
                             check<map_points_t>,
                             check<map_pose_t>,
                             check<map_trajectory_t>,
                             check<odometry_t>,
                             check<pose_t>,
                             check<raw_packet_t>,
                             check<resend_request_t>,
                             check<semantic_tile_t>,
                             check<service_status_t>,
                             check<tile_index_t>,
                             check<tile_request_t>,
                             check<voted_points_t>,
                             check<wheels_t>,
                             check<service_config_t>,
                             check<procman_lcm::deputy_info_t>,
                             check<procman_lcm::discovery_t>,
                             check<procman_lcm::orders_t>,
                             check<procman_lcm::output_t>,
                             check<service_config_t>};

}  // namespace
}  // namespace curbstone::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace curbstone::fuzz;
  Input input(data, size);
  const auto type = input.number<std::uint8_t>() % std::size(kChecks);
  kChecks[type](input.rest());
  return 0;
}
