#include "drivers/lidar/sources/pcap_source.hpp"

#include <fmt/format.h>
#include <pcap/pcap.h>

#include <array>
#include <stdexcept>

#include "drivers/lidar/sources/udp_frame.hpp"

namespace curbstone::lidar::sources {

class PcapSource::Impl {
 public:
  explicit Impl(const std::string& file) {
    std::array<char, PCAP_ERRBUF_SIZE> error{};
    handle_ = pcap_open_offline(file.c_str(), error.data());
    if (handle_ == nullptr) throw std::runtime_error(fmt::format("cannot read the capture: {}", error.data()));
    link_ = pcap_datalink(handle_);
    if (link_ != DLT_EN10MB && link_ != DLT_RAW && link_ != DLT_LINUX_SLL) {
      pcap_close(handle_);
      throw std::runtime_error(fmt::format("{}: link type {} is not supported: capture on an Ethernet interface", file,
                                           pcap_datalink_val_to_name(link_) ? pcap_datalink_val_to_name(link_) : "?"));
    }
  }
  ~Impl() { pcap_close(handle_); }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;

  [[nodiscard]] std::optional<UdpFrame> udp_in(std::span<const std::uint8_t> frame) const {
    if (link_ == DLT_RAW) return udp_in_ip(frame);
    return udp_in_ethernet(frame, link_ == DLT_LINUX_SLL ? 14 : 12);
  }

  pcap_t* handle_ = nullptr;

 private:
  int link_ = 0;
};

PcapSource::PcapSource(std::string file) : file_(std::move(file)), impl_(std::make_unique<Impl>(file_)) {}
PcapSource::~PcapSource() = default;

std::optional<PcapSource::Packet> PcapSource::next() {
  for (;;) {
    pcap_pkthdr* header = nullptr;
    const u_char* data = nullptr;
    const int status = pcap_next_ex(impl_->handle_, &header, &data);
    if (status == PCAP_ERROR_BREAK) return std::nullopt;
    if (status != 1) throw std::runtime_error(fmt::format("{}: {}", file_, pcap_geterr(impl_->handle_)));
    if (const auto udp = impl_->udp_in({data, header->caplen})) {
      return Packet{std::int64_t{header->ts.tv_sec} * 1'000'000 + header->ts.tv_usec, udp->port, udp->payload};
    }
    ++skipped_;
  }
}

}  // namespace curbstone::lidar::sources
