#include "tools/bench/voting/inputs/town_log.hpp"

#include "tools/simulate/log_recorder.hpp"
#include "tools/simulate/town_setup.hpp"

namespace curbstone::bench::voting::inputs {

void record_town_log(std::uint64_t seed, double seconds, const std::string& file) {
  constexpr std::int64_t kStart = 1'750'000'000'000'000;  // us
  simulate::record_drive(simulate::TownSetup(seed, seconds, kStart).drive(), file);
}

}  // namespace curbstone::bench::voting::inputs
