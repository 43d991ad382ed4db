#pragma once

#include <string>
#include <vector>

#include "common/config/config.hpp"
#include "common/config/vehicle.hpp"
#include "services/viewer/web/web_server.hpp"

namespace curbstone::viewer {

/// Section `viewer` of the vehicle's file.
struct ViewerConfig {
  VehicleConfig vehicle;
  std::string address = "127.0.0.1";  ///< to listen at
  int port = 8088;
  int ports = 1;
  std::string names;          ///< further host names for browsers, separated by commas
  int pages = 8;              ///< that may be connected at a time
  double frame_period = 0.1;  ///< s between two frames of a page
  int scan_points = 2000;     ///< of a LiDAR revolution, for pages that show it
  std::string network;        ///< file of the network namespace to listen in
  std::string assets;         ///< folder
  int foxglove_port = 0;
  std::string foxglove_origins = "https://app.foxglove.dev";  ///< with commas between

  void visit(ConfigVisitor& v) {
    v.section("vehicle", vehicle, "the vehicle");
    v.field("address", address,
            "to listen at; 127.0.0.1: this machine alone. There are no passwords: whoever reaches it sees all");
    v.field("port", port, {0, 65535}, "of the page; 0: any that is free");
    v.field("ports", ports, {1, 100}, "to try, from `port` on, until one is free");
    v.field("names", names, "host names that browsers may call it by, besides localhost and the address; with commas");
    v.field("pages", pages, {1, 64}, "that may watch at a time");
    v.field("frame_period", frame_period, {0.02, 5.0}, "s between two frames of a page");
    v.field("scan_points", scan_points, {0, 20'000}, "of a LiDAR revolution, for pages that show it");
    v.field("network", network, "network namespace to listen in, as /proc/PID/ns/net; empty: its own");
    v.field("foxglove_port", foxglove_port, {0, 65535},
            "port of the WebSocket server for Foxglove, at the same address, usually 8765; 0: there is none");
    v.field("foxglove_origins", foxglove_origins,
            "origins of pages that may connect to it, with commas; programs that send no origin always may");
    v.field("assets", assets, "folder with the page's files, for who works on them; empty: those in the program");
  }
};

/// Settings of the server for the page.
[[nodiscard]] web::WebSettings web_settings(const ViewerConfig& config);
/// Settings of the server for Foxglove.
[[nodiscard]] web::WebSettings endpoint_settings(const ViewerConfig& config);
/// The address of the page: "http://127.0.0.1:8088/".
[[nodiscard]] std::string page_address(const ViewerConfig& config, std::uint16_t port);

}  // namespace curbstone::viewer
