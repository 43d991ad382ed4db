#include "drivers/lidar/sources/pcap_source.hpp"

#include <fmt/format.h>
#include <pcap/pcap.h>

#include <algorithm>
#include <array>
#include <stdexcept>
#include <string_view>
#include <utility>
#include <vector>

#include "common/file_kind/file_kind.hpp"
#include "drivers/lidar/sources/pcapng_reader.hpp"

namespace curbstone::lidar::sources {

namespace {

constexpr int kLinktypeRaw = 101;  // in a file; DLT_RAW is what libpcap makes of it

using FrameReader = UdpFrame (*)(std::span<const std::uint8_t>);

/// nullptr for an unsupported link type.
FrameReader reader_of(int link) {
  switch (link) {
    case DLT_EN10MB:
      return udp_in_ethernet;
    case DLT_LINUX_SLL:
      return udp_in_sll;
    case DLT_LINUX_SLL2:
      return udp_in_sll2;
    case DLT_NULL:
    case DLT_LOOP:
      return udp_in_loopback;
    case DLT_RAW:
    case kLinktypeRaw:
    case DLT_IPV4:
      return udp_in_ip;
    default:
      return nullptr;
  }
}

}  // namespace

/// A classic capture is read by libpcap, one in pcapng by PcapngReader: there each frame has its own link type.
class PcapSource::Impl {
 public:
  struct Frame {
    std::int64_t seconds;
    std::int64_t microseconds;
    FrameReader read;  // nullptr: its link type is not supported
    std::span<const std::uint8_t> bytes;
  };
  explicit Impl(const std::string& file) : file_(file) {
    if (PcapngReader::is_pcapng(file))
      open_pcapng();
    else
      open_pcap();
  }
  ~Impl() {
    if (handle_ != nullptr) pcap_close(handle_);
  }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;

  [[nodiscard]] std::optional<Frame> next() {
    if (pcapng_) {
      const auto frame = pcapng_->next();
      if (!frame) return std::nullopt;
      return Frame{frame->seconds, frame->microseconds, reader_of(frame->link), frame->bytes};
    }
    pcap_pkthdr* header = nullptr;
    const u_char* data = nullptr;
    const int status = pcap_next_ex(handle_, &header, &data);
    if (status == PCAP_ERROR_BREAK) return std::nullopt;
    if (status != 1) throw std::runtime_error(fmt::format("{}: {}", file_, pcap_geterr(handle_)));
    return Frame{header->ts.tv_sec, header->ts.tv_usec, read_, {data, header->caplen}};
  }

 private:
  void open_pcap() {
    std::array<char, PCAP_ERRBUF_SIZE> error{};
    // libpcap converts stamps in nanoseconds to microseconds.
    handle_ = pcap_open_offline(file_.c_str(), error.data());
    if (handle_ == nullptr) {
      const std::string why = error.data();  // of a file that cannot be opened it begins with the name
      if (why.starts_with(file_)) throw std::runtime_error(why);
      const std::string_view kind = file_kind(file_);
      throw std::runtime_error(kind.empty() ? fmt::format("{}: not a capture: {}", file_, why)
                                            : fmt::format("{}: not a capture, but {}", file_, kind));
    }
    const int link = pcap_datalink(handle_);
    read_ = reader_of(link);
    if (read_ != nullptr) return;
    pcap_close(handle_);
    refuse(link);
  }
  /// One usable interface is enough: frames of others are counted.
  void open_pcapng() {
    pcapng_.emplace(file_);
    const std::vector<int> links = pcapng_->links();
    if (links.empty() || std::any_of(links.begin(), links.end(), [](int link) { return reader_of(link) != nullptr; }))
      return;
    refuse(links.front());
  }
  [[noreturn]] void refuse(int link) const {
    const char* const name = pcap_datalink_val_to_name(link);
    throw std::runtime_error(fmt::format("{}: link type {} is not supported: capture on an Ethernet interface", file_,
                                         name != nullptr ? name : std::to_string(link)));
  }

  std::string file_;
  std::optional<PcapngReader> pcapng_;
  pcap_t* handle_ = nullptr;    // of a classic capture
  FrameReader read_ = nullptr;  // of all its frames
};

namespace {

constexpr std::int64_t kLatest = 4'102'444'800;  // s since the Unix epoch: the year 2100

}  // namespace

PcapSource::PcapSource(std::string file) : file_(std::move(file)), impl_(std::make_unique<Impl>(file_)) {}
PcapSource::~PcapSource() = default;

std::optional<PcapSource::Packet> PcapSource::next() {
  while (const auto frame = impl_->next()) {
    if (frame->seconds < 0 || frame->seconds > kLatest)
      throw std::runtime_error(fmt::format("{}: damaged: a frame of {} s after 1970", file_, frame->seconds));
    const UdpFrame udp = frame->read != nullptr ? frame->read(frame->bytes) : UdpFrame{FrameKind::kOtherLink, 0, 0, {}};
    if (udp.kind == FrameKind::kUdp)
      return Packet{frame->seconds * 1'000'000 + frame->microseconds, udp.sender, udp.port, udp.payload};
    skip(udp.kind);
  }
  return std::nullopt;
}

void PcapSource::skip(FrameKind kind) {
  switch (kind) {
    case FrameKind::kFragment:
      ++skipped_.fragments;
      break;
    case FrameKind::kCut:
      ++skipped_.cut;
      break;
    case FrameKind::kOtherLink:
      ++skipped_.other_link;
      break;
    default:
      ++skipped_.not_udp;
  }
}

}  // namespace curbstone::lidar::sources
