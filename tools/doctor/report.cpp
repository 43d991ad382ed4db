#include "tools/doctor/report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "common/json/json_text.hpp"

namespace curbstone::doctor {

namespace {

using checks::Verdict;
using Kind = Verdict::Kind;

std::ptrdiff_t findings_of(const checks::Verdicts& verdicts) {
  return std::ranges::count(verdicts, Kind::kFinding, &Verdict::kind);
}

TerminalTable::Cell mark_of(Kind kind) {
  switch (kind) {
    case Kind::kGood:
      return {"ok", Colour::kGood};
    case Kind::kFinding:
      return {"!!", Colour::kBad};
    default:
      return {"?", Colour::kWarning};
  }
}

const char* word_of(Kind kind) {
  return kind == Kind::kGood ? "good" : kind == Kind::kFinding ? "finding" : "unknown";
}

}  // namespace

std::vector<std::string> report_lines(const checks::Verdicts& verdicts, const TextStyle& style) {
  TerminalTable table({{""}, {"check"}, {"what"}});
  for (const Verdict& verdict : verdicts) {
    table.add_row({mark_of(verdict.kind),
                   {verdict.check},
                   {verdict.what + (verdict.fix.empty() ? "" : "; fix: " + verdict.fix)}});
  }
  std::vector<std::string> lines = table.lines({style.colours, 0});  // not truncated, because commands are to be copied
  const auto findings = findings_of(verdicts);
  lines.push_back(findings == 0 ? styled_line("all is well", Colour::kGood, {style.colours, 0})
                                : styled_line(fmt::format("{} of {} checks found something", findings, verdicts.size()),
                                              Colour::kBad, {style.colours, 0}));
  return lines;
}

std::string report_json(const checks::Verdicts& verdicts) {
  nlohmann::json json = {{"findings", findings_of(verdicts)}, {"checks", nlohmann::json::array()}};
  for (const Verdict& verdict : verdicts) {
    json["checks"].push_back({{"check", verdict.check},
                              {"kind", word_of(verdict.kind)},
                              {"what", printable(verdict.what)},
                              {"fix", printable(verdict.fix)}});
  }
  return json_text(json, 2);
}

int exit_status(const checks::Verdicts& verdicts) {
  return findings_of(verdicts) == 0 ? 0 : 1;
}

}  // namespace curbstone::doctor
