#include "drivers/lidar/sources/capture_contents.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>
#include <utility>

namespace curbstone::lidar::sources {

namespace {

std::string text_of(const PortContents& port) {
  std::string lengths;
  if (port.by_length.size() == 1) {
    lengths = fmt::format("of {} bytes", port.by_length.begin()->first);
  } else {
    lengths = fmt::format("of {} to {} bytes", port.by_length.begin()->first, port.by_length.rbegin()->first);
  }
  return fmt::format("port {} from {}: {} packets {}", port.port, to_text(port.sender), port.packets, lengths);
}

}  // namespace

CaptureContents contents_of(const std::string& file) {
  CaptureContents contents;
  PcapSource source(file);
  std::map<std::pair<int, Ipv4>, PortContents> ports;
  try {
    while (const auto packet = source.next()) {
      PortContents& port = ports[{packet->port, packet->sender}];
      port.sender = packet->sender;
      port.port = packet->port;
      ++port.packets;
      ++port.by_length[packet->bytes.size()];
      ++contents.packets;
    }
  } catch (const std::runtime_error&) {
    // The contents of a truncated file are returned.
  }
  for (auto& [key, port] : ports) contents.ports.push_back(std::move(port));
  std::ranges::stable_sort(contents.ports, std::greater{}, &PortContents::packets);
  contents.skipped = source.skipped();
  return contents;
}

std::string to_text(const PcapSource::Skipped& skipped) {
  std::string text;
  if (skipped.fragments > 0) text += fmt::format("; {} IP fragments", skipped.fragments);
  if (skipped.cut > 0) text += fmt::format("; {} frames cut off", skipped.cut);
  if (skipped.not_udp > 0) text += fmt::format("; {} frames that are not UDP over IPv4", skipped.not_udp);
  if (skipped.other_link > 0) text += fmt::format("; {} frames of other link types", skipped.other_link);
  return text;
}

std::string to_text(const CaptureContents& contents, std::size_t ports) {
  std::string text;
  for (const PortContents& port : contents.ports) {
    if (ports-- == 0) break;
    text += (text.empty() ? "" : "; ") + text_of(port);
  }
  if (text.empty()) text = "no UDP packet at all";
  const std::size_t listed = static_cast<std::size_t>(std::ranges::count(text, ';')) + 1;
  if (contents.ports.size() > listed) text += fmt::format("; {} other ports", contents.ports.size() - listed);
  return text + to_text(contents.skipped);
}

}  // namespace curbstone::lidar::sources
