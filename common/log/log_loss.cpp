#include "common/log/log_loss.hpp"

#include <fmt/format.h>

namespace curbstone {

LogLoss& LogLoss::operator+=(const LogLoss& other) {
  places += other.places;
  bytes += other.bytes;
  missing += other.missing;
  seconds += other.seconds;
  cut_off += other.cut_off;
  return *this;
}

std::string to_text(const LogLoss& loss) {
  std::string text;
  if (loss.damaged()) {
    text = fmt::format("damaged at {} {}: {} bytes skipped, {} messages, {:.2f} s", loss.places,
                       loss.places == 1 ? "place" : "places", loss.bytes, loss.missing, loss.seconds);
  }
  if (loss.cut_off > 0)
    text += fmt::format("{}cut off in mid-record ({} bytes)", text.empty() ? "" : "; ", loss.cut_off);
  return text;
}

}  // namespace curbstone
