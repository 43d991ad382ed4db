#include "common/bus/refusal_share.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace curbstone {

void RefusalShare::used(std::int64_t now) {
  tick(now);
  ++used_;
}

void RefusalShare::refused(std::int64_t now, std::string_view cause) {
  tick(now);
  ++refused_;
  const auto it = causes_.find(cause);
  if (it == causes_.end())
    causes_.emplace(std::string(cause), 1);
  else
    ++it->second;
}

void RefusalShare::tick(std::int64_t now) {
  if (!began_ || now < *began_) began_ = now;  // the first packet, or the clock was set back
  if (now - *began_ < kWindow) return;
  close();
  began_ = now;
}

void RefusalShare::close() {
  const std::int64_t all = used_ + refused_;
  fault_.reset();
  if (all >= kMinRefusals && static_cast<double>(refused_) > kShare * static_cast<double>(all)) {
    const auto commonest = std::ranges::max_element(causes_, {}, [](const auto& cause) { return cause.second; });
    fault_ = fmt::format("{} % of the packets of a second were refused, most of them {} ({} of {})",
                         100 * refused_ / all, commonest->first, commonest->second, all);
  }
  used_ = 0;
  refused_ = 0;
  causes_.clear();
}

}  // namespace curbstone
