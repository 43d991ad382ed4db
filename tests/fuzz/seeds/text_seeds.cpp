// Texts: configurations, traces, descriptions.
#include "tests/fuzz/seeds/seed_folder.hpp"

namespace curbstone::fuzz {
namespace {

constexpr const char* kCandump =
    "(1608055974.318981) can0 181#0A0100000A020000\n(1608055974.319981) can0 202#903C\n"
    "(1608055974.320000) can1 12345678#R\n(1608055974.330000) can0 181##100\n";
constexpr const char* kCandumpShown =
    " (1608055974.318981)  can0  181   [8]  0A 01 00 00 0A 02 00 00   '........'\n"
    " (2020-12-15 18:12:54.3)  can1  TX - -  12345678   [0]  remote request\n (000.0)  can0  20000088   [1]  00 "
    "ERRORFRAME\n";
constexpr const char* kPcan10 =
    ";####\n     1)     17535  00000100  2  01 02\n     2)     17540  FFFFFFFF  4  00 00 00 08 -- -- -- -- BUSHEAVY\n";
constexpr const char* kPcan13 =
    ";$FILEVERSION=1.3\n;$STARTTIME=40511.3973\n     1)        17535.4 1  Tx    00000100 -  2    01 02\n";
constexpr const char* kPcan11 =
    ";$FILEVERSION=1.1\n;$STARTTIME=40511.3973\n;---\n"
    "     1)      1059.9  Rx         0300  7  00 00 00 00 04 00 00\n     2)      1283.2  Rx         0300  4  RTR\n";
constexpr const char* kPcan21 =
    ";$FILEVERSION=2.1\n;$STARTTIME=40511.3973\n;$COLUMNS=N,O,T,B,I,d,R,L,D\n"
    "      1      1059.900 DT 1     0300 Rx -  7    00 00 00 00 04 00 00\n      2      1060.000 ST 1          Rx -  4  "
    "  00 00 00 08\n";

constexpr const char* kPly =
    "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float z\nproperty uchar "
    "red\n"
    "element face 1\nproperty list uchar int vertex_indices\nend_header\n1 2 3 255\n-1.5 2e-3 nan 0\n2 0 1\n";
constexpr std::string_view kBinaryPly =
    "ply\nformat binary_big_endian 1.0\nelement list 1\nproperty list uchar short a\nelement vertex 1\nproperty double "
    "x\n"
    "property float y\nproperty float "
    "z\nend_header\n\x02\x01\x02\x03\x04?\xF0\x01\x01\x01\x01\x01\x01@@\x01\x01@\x80\x01\x01";
constexpr const char* kPcd =
    "# .PCD v0.7\nVERSION 0.7\nFIELDS x y z rgb\nSIZE 4 4 4 4\nTYPE F F F U\nCOUNT 1 1 1 1\nWIDTH 2\nHEIGHT 1\n"
    "VIEWPOINT 0 0 0 1 0 0 0\nPOINTS 2\nDATA ascii\n1 2 3 4\n-1 2.5 nan 0\n";
constexpr const char* kBinaryPcd =
    "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 1\nHEIGHT 1\nPOINTS 1\nDATA binary\n"
    "abc?def@ghi@";

void write(const SeedFolder& folder, const std::string& target, const std::string& name, std::string_view text) {
  const auto bytes = bytes_of(text);
  folder.write(target, name, {bytes.begin(), bytes.end()});
}

}  // namespace

void write_text_seeds(const SeedFolder& folder) {
  const std::filesystem::path source = CURBSTONE_SOURCE_DIR;
  write(folder, "can_trace", "candump", kCandump);
  write(folder, "can_trace", "candump_shown", kCandumpShown);
  write(folder, "can_trace", "pcan10", kPcan10);
  write(folder, "can_trace", "pcan11", kPcan11);
  write(folder, "can_trace", "pcan13", kPcan13);
  write(folder, "can_trace", "pcan21", kPcan21);
  for (const char* name : {"can/fsae_candump.log", "can/pcan2.trc"}) {
    const Seed seed = SeedFolder::read(folder.recording(name), 4096);
    if (!seed.empty()) folder.write("can_trace", std::filesystem::path(name).filename(), seed);
  }
  write(folder, "can_signal", "intel", "181 0|32@1- (1,0)\n\x01\x02\x03\x04\x05\x06\x07\x08");
  write(folder, "can_signal", "motorola", "18FEF100 7|16@0+ (0.00390625,-12)\n\x01\x02\x03\x04");
  write(folder, "cloud", "ply", kPly);
  write(folder, "cloud", "binary_ply", kBinaryPly);
  write(folder, "cloud", "pcd", kPcd);
  write(folder, "cloud", "binary_pcd", kBinaryPcd);
  write(folder, "angles", "with_azimuth", "# elevation,azimuth\n-15.0,0.1\n-13,0\n\n15,-2.5\n");
  write(folder, "angles", "elevation", "-15\n-13\n-11\n");

  const Seed ugv = SeedFolder::read(source / "config/ugv.yaml");
  for (std::uint8_t process = 0; process < 9; ++process) {
    Seed seed = {process, 0};
    put(seed, ugv);
    folder.write("config", "ugv_" + std::to_string(process), seed);
    seed = {process, 1};
    put(seed, bytes_of("timing.delay=0.1"));
    folder.write("config", "assignment_" + std::to_string(process), seed);
  }
  for (const char* name : {"ugv.cfg", "demo.cfg"})
    folder.write("procman_config", name, SeedFolder::read(source / "procman" / name));
  write(folder, "procman_config", "scripts",
        "group \"a\" { cmd \"b\" { exec = \"X=1 $HOME/c 'd e'\"; host = \"vehicle\"; auto_respawn = \"true\"; } }\n"
        "script \"go\" { start group \"a\" wait \"running\"; wait ms 100; run_script \"go\"; stop cmd \"b\"; }\n");
  write(folder, "foxglove_request", "subscribe", R"({"op":"subscribe","subscriptions":[{"id":0,"channelId":3}]})");
  write(folder, "foxglove_request", "unsubscribe", R"({"op":"unsubscribe","subscriptionIds":[0]})");
}

}  // namespace curbstone::fuzz
