#include "common/config/config.hpp"

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <fstream>
#include <sstream>
#include <system_error>
#include <type_traits>

#include "common/config/duplicate_keys.hpp"
#include "common/config/known_keys.hpp"
#include "common/config/number_advice.hpp"
#include "common/config/second_document.hpp"
#include "common/config/text_form.hpp"

namespace curbstone {

namespace {

constexpr Range kAngle{-6.2832, 6.2832};     // rad, a whole turn: more is in degrees
constexpr std::string_view kSet = "--set ";  // begins the name of a setting that is in no file

/// ", not '0.2 m'": for errors.
std::string what_stands_there(const YAML::Node& node) {
  if (node.IsSequence()) return ", not a list";
  if (node.IsMap()) return ", not a map";
  return node.IsNull() ? ", and nothing stands there" : fmt::format(", not '{}'", node.Scalar());
}

/// The visitor that puts values into the struct.
class Loader final : public ConfigVisitor {
 public:
  /// `config`: the whole configuration, to suggest where else a key may belong.
  Loader(const YAML::Node& root, std::string file, std::string path, AnyConfig& config)
      : file_(std::move(file)), path_(path), config_(config) {
    enter(root, std::move(path));
  }

  void field(const char* key, bool& value, const char*) override { scalar(key, value, "true or false"); }
  void field(const char* key, int& value, Range range, const char* help) override {
    if (const YAML::Node node = find(key)) number(node, key, value, "a whole number", range, help);
  }
  void field(const char* key, double& value, Range range, const char* help) override {
    if (const YAML::Node node = find(key)) number(node, key, value, "a number", range, help);
  }
  void field(const char* key, std::string& value, const char*) override {
    std::string read = value;
    if (!scalar(key, read, "a text")) return;
    if (read.starts_with("~/") || read.starts_with('$'))
      fail(key, fmt::format("'{}' stays as it is, as no shell expands it: write the whole path", read));
    value = read;
  }
  void choice(const char* key, std::string& value, const std::vector<std::string>& choices, const char*) override {
    if (scalar(key, value, "a text") && std::find(choices.begin(), choices.end(), value) == choices.end()) {
      fail(key, fmt::format("'{}' is not one of {}", value, fmt::join(choices, ", ")));
    }
  }
  void field(const char* key, std::vector<double>& value, Range range, const char* help, bool any_length) override {
    const YAML::Node list = find(key);
    if (!list) return;
    const std::string wanted = any_length ? "numbers" : fmt::format("{} numbers", value.size());
    if (!list.IsSequence())
      fail(key, fmt::format("expected a list of {}{} ({})", wanted, what_stands_there(list), help));
    if (!any_length && list.size() != value.size()) {
      fail(key, fmt::format("expected {}, got {}{} ({})", wanted, list.size(),
                            list.size() > value.size() ? "; decimals take a point, not a comma" : "", help));
    }
    std::vector<double> read(list.size());
    for (std::size_t i = 0; i < read.size(); ++i) number(list[i], key, read[i], "a number", range, help);
    value = read;
  }

  void pose(const char* key, std::vector<double>& value, Range range, const char* help) override {
    std::vector<double> read = value;
    field(key, read, {}, help, false);
    for (std::size_t i = 0; i < read.size(); ++i) check(key, read[i], i < 3 ? range : kAngle, help);
    value = read;
  }

  /// Call it after the struct has visited all its fields.
  void leave() {
    const Level& level = levels_.back();
    if (level.node.IsMap()) {
      for (const auto& entry : level.node) {
        if (!entry.first.IsScalar()) fail_at(entry.first, level.path + "?", "expected a key that is a word");
        const auto key = entry.first.as<std::string>();
        if (std::find(level.known.begin(), level.known.end(), key) == level.known.end()) {
          fail_at(entry.first, level.path + key, unknown_key(key, level.known, path_, config_));
        }
      }
    }
    levels_.pop_back();
  }

 protected:
  bool begin_section(const char* key, const char*) override {
    Level& level = levels_.back();
    level.known.emplace_back(key);
    if (!level.node.IsMap() || !level.node[key]) return false;
    // The section that processes share is named as it stands in the file, at the top.
    const bool is_shared = levels_.size() == 1 && std::string_view(key) == "vehicle";
    enter(level.node[key], (is_shared ? "" : level.path) + key + ".");
    return true;
  }
  void end_section() override { leave(); }

 private:
  struct Level {
    YAML::Node node;
    std::string path;  // "ekf.noise."
    std::vector<std::string> known;
  };

  void enter(const YAML::Node& node, std::string path) {
    if (!node.IsMap() && !node.IsNull()) {
      const bool has_colon = node.IsScalar() && node.Scalar().find(':') != std::string::npos;
      fail_at(node, path.substr(0, path.size() - 1),
              fmt::format("expected a map of keys and values{}{}", what_stands_there(node),
                          has_colon ? ": a colon needs a space behind it" : ""));
    }
    levels_.push_back({node, std::move(path), {}});
  }
  /// The value of the key, which is undefined where the file does not have it.
  YAML::Node find(const char* key) {
    Level& level = levels_.back();
    level.known.emplace_back(key);
    return level.node.IsMap() ? level.node[key] : YAML::Node(YAML::NodeType::Undefined);
  }
  template <class T>
  bool scalar(const char* key, T& value, const char* expected) {
    const YAML::Node node = find(key);
    if (!node) return false;
    if constexpr (std::is_same_v<T, std::string>) {
      if (node.IsNull()) {  // "key:" without a value; yaml-cpp would return "null"
        value.clear();
        return true;
      }
    }
    try {
      value = node.as<T>();
    } catch (const YAML::Exception&) {
      fail(key, fmt::format("expected {}{}", expected, what_stands_there(node)));
    }
    return true;
  }
  /// `help` says the unit.
  template <class T>
  void number(const YAML::Node& node, const char* key, T& value, const char* expected, Range range, const char* help) {
    const std::string text = node.IsScalar() ? node.Scalar() : "";
    if (const auto decimal = without_leading_zeros(text); std::is_same_v<T, int> && decimal)
      fail(key, fmt::format("'{}' may be octal: write {}", text, *decimal));
    try {
      value = node.as<T>();
    } catch (const YAML::Exception&) {
      fail(key, fmt::format("expected {}{}{} ({})", expected, what_stands_there(node), number_advice(text), help));
    }
    check(key, value, range, help);
  }
  void check(const char* key, double value, Range range, const char* help) const {
    if (!(value >= range.min && value <= range.max))
      fail(key, fmt::format("{} is not within {} .. {} ({})", value, range.min, range.max, help));
  }
  [[noreturn]] void fail(const char* key, const std::string& what) const {
    const Level& level = levels_.back();
    YAML::Node at = level.node[key];
    if (at.IsNull()) {  // yaml-cpp has found it where the next key is
      for (const auto& entry : level.node) {
        if (entry.first.IsScalar() && entry.first.Scalar() == key) at.reset(entry.first);
      }
    }
    fail_at(at, level.path + key, what);
  }
  [[noreturn]] void fail_at(const YAML::Node& node, const std::string& path, const std::string& what) const {
    const std::string line = file_.starts_with(kSet) ? "" : fmt::format("{}:", node.Mark().line + 1);
    throw ConfigError(fmt::format("{}:{} {}: {}", file_, line, path, what));
  }

  std::string file_;
  std::string path_;
  AnyConfig& config_;
  std::vector<Level> levels_;
};

class Dumper final : public ConfigVisitor {
 public:
  void field(const char* key, bool& value, const char* help) override { line(key, value ? "true" : "false", help); }
  void field(const char* key, int& value, Range range, const char* help) override {
    line(key, fmt::format("{}", value), help, range);
  }
  void field(const char* key, double& value, Range range, const char* help) override {
    line(key, number(value), help, range);
  }
  void field(const char* key, std::string& value, const char* help) override {
    YAML::Emitter emitter;
    emitter << YAML::DoubleQuoted << value;
    line(key, emitter.c_str(), help);
  }
  void choice(const char* key, std::string& value, const std::vector<std::string>& choices, const char* help) override {
    line(key, value, fmt::format("{} ({})", help, fmt::join(choices, " | ")).c_str());
  }
  void field(const char* key, std::vector<double>& value, Range range, const char* help, bool) override {
    std::vector<std::string> items;
    items.reserve(value.size());
    for (const double x : value) items.push_back(number(x));
    line(key, fmt::format("[{}]", fmt::join(items, ", ")), help, range);
  }
  bool begin_section(const char* key, const char* help) override {
    text_ += fmt::format("{:{}}{}:  # {}\n", "", 2 * depth_, key, help);
    ++depth_;
    return true;
  }
  void end_section() override { --depth_; }

  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  static std::string number(double value) {
    if (std::isnan(value)) return ".nan";
    if (std::isinf(value)) return value > 0 ? ".inf" : "-.inf";
    return fmt::format("{}", value);
  }
  void line(const char* key, const std::string& value, const char* help, Range range = {}) {
    std::string bounds;
    if (std::isfinite(range.min) && std::isfinite(range.max)) {
      bounds = fmt::format(" [{} .. {}]", range.min, range.max);
    } else if (std::isfinite(range.min)) {
      bounds = fmt::format(" [>= {}]", range.min);
    }
    text_ += fmt::format("{:{}}{}: {}  # {}{}\n", "", 2 * depth_, key, value, help, bounds);
  }
  std::string text_;
  int depth_ = 0;
};

/// Loads a node whose root map holds exactly the struct's keys.
void load_node(const YAML::Node& node, const std::string& file, const std::string& path, AnyConfig& config) {
  Loader loader(node, file, path, config);
  config.visit(loader);
  loader.leave();
}

}  // namespace

void parse_config(std::string_view text, const std::string& name, const std::string& section, SectionNames sections,
                  AnyConfig& config) {
  refuse_odd_text(text, name);
  YAML::Node root;
  try {
    root = YAML::Load(std::string(text));
    refuse_second_document(std::string(text), name);
    refuse_duplicate_keys(std::string(text), name);
  } catch (const YAML::ParserException& error) {
    throw ConfigError(fmt::format("{}:{}: {}{}", name, error.mark.line + 1, error.msg,
                                  syntax_advice(text, error.mark.line, error.msg)));
  }
  if (root.IsNull()) return;
  if (!root.IsMap()) throw ConfigError(fmt::format("{}:1: expected a map with a section for each process", name));
  std::vector<std::string> known = {"vehicle"};
  known.insert(known.end(), sections.begin(), sections.end());
  for (const auto& entry : root) {
    if (!entry.first.IsScalar())
      throw ConfigError(fmt::format("{}:{}: expected the name of a section", name, entry.first.Mark().line + 1));
    const auto key = entry.first.as<std::string>();
    if (std::find(known.begin(), known.end(), key) == known.end()) {
      throw ConfigError(fmt::format("{}:{}: {}: {}", name, entry.first.Mark().line + 1, key,
                                    unknown_key(key, known, section + ".", config)));
    }
  }
  YAML::Node own = root[section] ? root[section] : YAML::Node(YAML::NodeType::Map);
  // The section that several processes share is at the top level of the file.
  if (root["vehicle"] && has_section(config, "vehicle")) {
    if (own.IsMap() && own["vehicle"]) {
      throw ConfigError(fmt::format("{}:{}: {}.vehicle: stands at the top of the file already", name,
                                    own["vehicle"].Mark().line + 1, section));
    }
    if (own.IsNull()) own = YAML::Node(YAML::NodeType::Map);
    if (own.IsMap()) own["vehicle"] = root["vehicle"];
  }
  load_node(own, name, section + ".", config);
}

void load_config(const std::string& file, const std::string& section, SectionNames sections, AnyConfig& config) {
  errno = 0;
  std::ifstream in(file);
  std::stringstream text;
  if (in && in.peek() == std::ifstream::traits_type::eof() && !in.bad())
    throw ConfigError(fmt::format("{}: is empty", file));
  if (!in || !(text << in.rdbuf()))
    throw ConfigError(fmt::format("{}: cannot be read: {}", file, std::generic_category().message(errno)));
  parse_config(text.str(), file, section, sections, config);
}

void set_config_value(std::string_view assignment, AnyConfig& config) {
  const auto equals = assignment.find('=');
  if (equals == std::string_view::npos || equals == 0) {
    throw ConfigError(fmt::format("--set {}: expected KEY=VALUE", assignment));
  }
  std::string value(assignment.substr(equals + 1));
  const bool is_plain = value.find_first_of("[{'\"") != 0;
  if (is_plain && value.find_first_of(",'") != std::string::npos) {  // in "{b: 1,2}", 2 would be a key
    for (std::size_t at = 0; (at = value.find('\'', at)) != std::string::npos; at += 2) value.insert(at, 1, '\'');
    value = "'" + value + "'";
  }
  std::string yaml;  // a.b=1 becomes {a: {b: 1}}
  std::string key(assignment.substr(0, equals));
  std::string closing;
  for (std::size_t dot; (dot = key.find('.')) != std::string::npos; key.erase(0, dot + 1)) {
    yaml += "{" + key.substr(0, dot) + ": ";
    closing += "}";
  }
  yaml += "{" + key + ": " + value + "}" + closing;
  try {
    load_node(YAML::Load(yaml), std::string(kSet) + std::string(assignment), "", config);
  } catch (const YAML::ParserException& error) {
    throw ConfigError(fmt::format("--set {}: {}", assignment, error.msg));
  }
}

void set_section_values(const std::string& section, const std::vector<std::string>& assignments, AnyConfig& config) {
  const std::string prefix = section + ".";
  for (const std::string& assignment : assignments) {
    if (assignment.starts_with(prefix)) set_config_value(std::string_view(assignment).substr(prefix.size()), config);
  }
}

std::string dump_config(const std::string& section, AnyConfig& config) {
  Dumper dumper;
  dumper.begin_section(section.c_str(), "effective configuration");
  config.visit(dumper);
  return dumper.text();
}

std::string config_hash(const std::string& section, AnyConfig& config) {
  YAML::Emitter values;  // without the comments: other words are no other settings
  values << YAML::Load(dump_config(section, config));
  std::uint64_t hash = 0xcbf29ce484222325ULL;
  for (const char c : std::string_view(values.c_str())) {
    hash = (hash ^ static_cast<std::uint8_t>(c)) * 0x100000001b3ULL;
  }
  return fmt::format("{:016x}", hash);
}

}  // namespace curbstone
