#include "drivers/encoder/traces/foreign_recording.hpp"

#include <regex>

namespace curbstone::encoder::traces {

namespace {

/// candump's "(1.5)  can0  RX - -  202   [2]  " and behind it `data`.
std::regex shown(const std::string& data) {
  return std::regex(R"(\s*(\([^)]*\))?\s*\S+\s+([TR]X \S \S\s+)?[0-9A-Fa-f]{3,8}\s+[\[{][0-9A-F]+[\]}]\s+)" + data);
}

bool fits(std::string_view line, const std::regex& pattern) {
  return std::regex_search(line.begin(), line.end(), pattern, std::regex_constants::match_continuous);
}

}  // namespace

std::string foreign_recording(std::string_view line) {
  static const std::regex kSwapped = shown("[0-9A-Fa-f]{2,8}`[0-9A-Fa-f]{2,8}");
  static const std::regex kBits = shown(R"([01]{8}(\s|$))");
  static const std::regex kAsc(R"((date \w{3} \w{3} |base (hex|dec)\s+timestamps |Begin Trigger ?[Bb]lock))");
  constexpr const char* kRecord = "; record with candump -l, -ta or -tz alone";
  const std::size_t begin = line.find_first_not_of(" \t\r");
  if (begin == std::string_view::npos) return {};
  if (line[begin] == '\x1b')
    return R"(lines with colours (candump -c); take them out with sed 's/\x1b\[[0-9;]*m//g', or record without -c)";
  if (line.starts_with("LOGG"))
    return "a Vector BLF file; make a candump log of it with python-can: can_logconvert FILE drive.log";
  if (fits(line, kAsc))
    return "a Vector ASC file; make a candump log of it with can-utils: asc2log -I FILE -O drive.log";
  if (fits(line, kSwapped)) return std::string("the bytes are in reverse order (candump -S)") + kRecord;
  if (fits(line, kBits)) return std::string("the bytes are written as bits (candump -i)") + kRecord;
  return {};
}

}  // namespace curbstone::encoder::traces
