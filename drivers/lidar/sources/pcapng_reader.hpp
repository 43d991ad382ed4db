#pragma once

#include <cstdint>
#include <fstream>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace curbstone::lidar::sources {

/// Reads the frames of a pcapng capture, each with the link type of its own interface: a capture of several interfaces
/// may mix them, which libpcap refuses. Any number of sections, of either byte order. Source: IETF
/// draft-ietf-opsawg-pcapng.
class PcapngReader {
 public:
  struct Frame {
    std::int64_t seconds = 0;             ///< since the Unix epoch; not checked; 0 of a frame without a stamp
    std::int64_t microseconds = 0;        ///< of the second
    int link = 0;                         ///< LINKTYPE of the interface
    std::span<const std::uint8_t> bytes;  ///< valid until the next call
  };

  /// Whether the file begins like a pcapng capture.
  [[nodiscard]] static bool is_pcapng(const std::string& file);

  /// Reads up to the first frame. Throws std::runtime_error if the file is no pcapng capture.
  explicit PcapngReader(const std::string& file);

  /// The link types of the interfaces described so far.
  [[nodiscard]] std::vector<int> links() const;
  /// The next frame; nothing at the end. Throws std::runtime_error if the file is damaged or cut off.
  [[nodiscard]] std::optional<Frame> next();

 private:
  struct Interface {
    int link = 0;
    std::uint32_t snap_length = 0;
    std::int64_t offset = 0;  // s to add to each stamp
    int exponent = 6;         // a stamp counts units of 10^-exponent s, or 2^-exponent s
    bool is_binary = false;
  };
  struct Head {
    std::uint32_t type = 0;
    std::uint32_t length = 0;  // bytes of the body
  };
  template <class Number>
  [[nodiscard]] Number number(std::span<const std::uint8_t> bytes) const;
  [[nodiscard]] bool read(std::span<std::uint8_t> bytes);
  [[nodiscard]] bool read_head();
  void read_body();
  void begin_section();
  void describe_interface();
  [[nodiscard]] Frame frame_of(std::size_t interface, std::uint64_t stamp, std::size_t at, std::size_t length) const;
  [[noreturn]] void damaged(const std::string& what) const;

  std::string file_;
  std::ifstream in_;
  bool is_big_endian_ = false;
  std::vector<Interface> interfaces_;  // of this section
  std::vector<int> links_;
  std::optional<Head> head_;  // of the block whose body comes next
  std::vector<std::uint8_t> body_;
};

}  // namespace curbstone::lidar::sources
