#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "common/bus/counters.hpp"

namespace curbstone::viewer::web {

/// The id of a page's connection; never reused.
using PageId = std::uint64_t;
using Frame = std::shared_ptr<const std::vector<std::uint8_t>>;

/// The connected pages. All calls come from one thread.
class Connections {
 public:
  struct Event {
    enum class Kind { kConnected, kMessage, kDisconnected };
    PageId page = 0;
    Kind kind = Kind::kConnected;
    std::string text;     ///< what the page sent; not validated
    std::int64_t at = 0;  ///< us since the Unix epoch
  };

  virtual ~Connections() = default;
  /// What happened since the last call, in order.
  [[nodiscard]] virtual std::vector<Event> take_events() = 0;
  /// Sends a binary message. Does nothing if the page has left.
  virtual void send(PageId page, Frame frame) = 0;
  /// Sends a text message.
  virtual void send_text(PageId page, std::string text) = 0;
  /// Bytes queued and not sent yet; 0 for a page that has left.
  [[nodiscard]] virtual std::size_t queued(PageId page) const = 0;
  [[nodiscard]] virtual Counters counters() const = 0;
};

}  // namespace curbstone::viewer::web
