#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <procman_lcm/deputy_info_t.hpp>
#include <string>
#include <vector>

#include "tools/spy/board/channel_statistics.hpp"
#include "tools/spy/board/service_board.hpp"

namespace curbstone::spy::board {

/// State of a channel: its type, statistics and last message.
struct ChannelState {
  std::string type;              ///< "curbstone.imu_t"; empty: not one of lcmtypes/
  std::int64_t undecodable = 0;  ///< messages of an unknown type, or damaged
  ChannelStatistics statistics;
  std::vector<std::uint8_t> last;  ///< bytes of the last message; only for the followed channel
};

/// A deputy, by its PM_INFO.
struct DeputyState {
  procman_lcm::deputy_info_t info;
  std::int64_t heard = 0;  ///< us, time of reception
  std::int64_t clock = 0;  ///< us: the clock of its host minus ours, less the transit time
};

/// The state of everything received on a bus. Messages and their times of reception (us since the Unix epoch) go in.
/// Pure; invalid bytes are tolerated, and memory is bounded.
class BusBoard {
 public:
  static constexpr std::size_t kMaxChannels = 500;
  static constexpr std::size_t kMaxDeputies = 50;

  /// `followed`: the channel whose last message is kept; empty: none.
  explicit BusBoard(std::string followed) : followed_(std::move(followed)) {}

  void on_message(const std::string& channel, const void* data, std::size_t size, std::int64_t now);

  [[nodiscard]] const std::map<std::string, ChannelState>& channels() const { return channels_; }
  [[nodiscard]] const ServiceBoard& services() const { return services_; }
  [[nodiscard]] const std::map<std::string, DeputyState>& deputies() const { return deputies_; }
  [[nodiscard]] const std::string& followed() const { return followed_; }
  /// Messages on channels beyond kMaxChannels.
  [[nodiscard]] std::int64_t unlisted() const { return unlisted_; }

 private:
  bool decode_known(const std::string& channel, const void* data, std::size_t size, std::int64_t now);

  std::string followed_;
  std::map<std::string, ChannelState> channels_;
  ServiceBoard services_;
  std::map<std::string, DeputyState> deputies_;
  std::int64_t unlisted_ = 0;
};

}  // namespace curbstone::spy::board
