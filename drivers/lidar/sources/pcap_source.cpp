#include "drivers/lidar/sources/pcap_source.hpp"

#include <fmt/format.h>
#include <pcap/pcap.h>

#include <array>
#include <stdexcept>

namespace curbstone::lidar::sources {

namespace {

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
    case DLT_IPV4:
      return udp_in_ip;
    default:
      return nullptr;
  }
}

}  // namespace

class PcapSource::Impl {
 public:
  explicit Impl(const std::string& file) {
    std::array<char, PCAP_ERRBUF_SIZE> error{};
    // libpcap converts stamps in nanoseconds to microseconds.
    handle_ = pcap_open_offline(file.c_str(), error.data());
    if (handle_ == nullptr) throw std::runtime_error(fmt::format("cannot read the capture: {}", error.data()));
    const int link = pcap_datalink(handle_);
    read_ = reader_of(link);
    if (read_ == nullptr) {
      pcap_close(handle_);
      throw std::runtime_error(fmt::format("{}: link type {} is not supported: capture on an Ethernet interface", file,
                                           pcap_datalink_val_to_name(link) ? pcap_datalink_val_to_name(link) : "?"));
    }
  }
  ~Impl() { pcap_close(handle_); }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;

  [[nodiscard]] UdpFrame udp_in(std::span<const std::uint8_t> frame) const { return read_(frame); }

  pcap_t* handle_ = nullptr;

 private:
  FrameReader read_ = nullptr;
};

namespace {

constexpr std::int64_t kLatest = 4'102'444'800;  // s since the Unix epoch: the year 2100

}  // namespace

PcapSource::PcapSource(std::string file) : file_(std::move(file)), impl_(std::make_unique<Impl>(file_)) {}
PcapSource::~PcapSource() = default;

std::optional<PcapSource::Packet> PcapSource::next() {
  for (;;) {
    pcap_pkthdr* header = nullptr;
    const u_char* data = nullptr;
    const int status = pcap_next_ex(impl_->handle_, &header, &data);
    if (status == PCAP_ERROR_BREAK) return std::nullopt;
    if (status != 1) throw std::runtime_error(fmt::format("{}: {}", file_, pcap_geterr(impl_->handle_)));
    const UdpFrame udp = impl_->udp_in({data, header->caplen});
    const std::int64_t seconds = header->ts.tv_sec;
    if (seconds < 0 || seconds > kLatest)
      throw std::runtime_error(fmt::format("{}: damaged: a frame of {} s after 1970", file_, seconds));
    if (udp.kind == FrameKind::kUdp)
      return Packet{seconds * 1'000'000 + header->ts.tv_usec, udp.sender, udp.port, udp.payload};
    skip(udp.kind);
  }
}

void PcapSource::skip(FrameKind kind) {
  switch (kind) {
    case FrameKind::kFragment:
      ++skipped_.fragments;
      break;
    case FrameKind::kCut:
      ++skipped_.cut;
      break;
    default:
      ++skipped_.not_udp;
  }
}

}  // namespace curbstone::lidar::sources
