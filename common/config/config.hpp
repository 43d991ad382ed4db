#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

namespace curbstone {

/// Inclusive bounds of a number in a configuration.
struct Range {
  double min = -std::numeric_limits<double>::infinity();
  double max = std::numeric_limits<double>::infinity();
};

/// Visits the fields of a configuration struct: one visitor loads, another dumps. A struct takes part with
///
///     struct EkfConfig {
///       double track_width = 0.6;  ///< m, > 0
///       void visit(ConfigVisitor& v) { v.field("track_width", track_width, {0.01, 10}, "m, between the wheels"); }
///     };
///
/// Defaults live in the struct; a file only overrides them. `help` states unit and meaning, for --dump-config.
class ConfigVisitor {
 public:
  virtual ~ConfigVisitor() = default;
  virtual void field(const char* key, bool& value, const char* help) = 0;
  virtual void field(const char* key, int& value, Range range, const char* help) = 0;
  virtual void field(const char* key, double& value, Range range, const char* help) = 0;
  virtual void field(const char* key, std::string& value, const char* help) = 0;
  /// A word that must be one of `choices`.
  virtual void choice(const char* key, std::string& value, const std::vector<std::string>& choices,
                      const char* help) = 0;
  /// The same for an enumeration: each word stands for one of its values, and each value has a word.
  template <class Enum>
  requires std::is_enum_v<Enum>
  void choice(const char* key, Enum& value, const std::vector<std::pair<std::string, Enum>>& choices,
              const char* help) {
    std::vector<std::string> words;
    std::string word;
    for (const auto& [name, meaning] : choices) {
      words.push_back(name);
      if (meaning == value) word = name;
    }
    choice(key, word, words, help);
    for (const auto& [name, meaning] : choices) {
      if (name == word) value = meaning;
    }
  }
  /// A list with exactly as many numbers as `value` holds, or with any number of them if `any_length`.
  virtual void field(const char* key, std::vector<double>& value, Range range, const char* help,
                     bool any_length = false) = 0;
  /// x, y, z in m and roll, pitch, yaw in rad. `range` is that of the position.
  virtual void pose(const char* key, std::vector<double>& value, Range range, const char* help) {
    field(key, value, range, help);
  }
  template <class Section>
  void section(const char* key, Section& section, const char* help) {
    if (begin_section(key, help)) {
      section.visit(*this);
      end_section();
    }
  }

 protected:
  virtual bool begin_section(const char* key, const char* help) = 0;
  virtual void end_section() = 0;
};

/// A configuration that cannot be used: "ugv.yaml:12: ekf.trak_width: unknown key; did you mean track_width?"
class ConfigError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Any struct with a visit() method, with its type erased.
class AnyConfig {
 public:
  virtual ~AnyConfig() = default;
  virtual void visit(ConfigVisitor& visitor) = 0;
};
template <class Config>
class ConfigOf final : public AnyConfig {
 public:
  Config value;
  void visit(ConfigVisitor& visitor) override { value.visit(visitor); }
};

/// The sections that a file may have besides `vehicle:`. This layer knows no process by name, so the caller names them.
using SectionNames = std::span<const std::string_view>;

/// Loads section `section` of a YAML file over the present values of `config`. One file describes one vehicle and has a
/// section for each process (`ekf:`, `mapper:`...). A missing section leaves the defaults. Throws ConfigError (file,
/// line, key, what was expected) on an unreadable file, bad YAML, a section that is not in `sections`, an unknown key,
/// a duplicate key, a wrong type or a number out of range.
void load_config(const std::string& file, const std::string& section, SectionNames sections, AnyConfig& config);
/// The same from text; `name` stands for the file in errors.
void parse_config(std::string_view text, const std::string& name, const std::string& section, SectionNames sections,
                  AnyConfig& config);
/// Sets one value by its dotted key as text: "icp.iterations=20".
void set_config_value(std::string_view assignment, AnyConfig& config);
/// Applies, in order, those assignments SECTION.KEY=VALUE whose section is `section`; ignores all others.
void set_section_values(const std::string& section, const std::vector<std::string>& assignments, AnyConfig& config);
/// The effective configuration as commented YAML, which load_config() can read.
[[nodiscard]] std::string dump_config(const std::string& section, AnyConfig& config);
/// 16 hexadecimal digits over the keys and values of the dump, without its comments (FNV-1a, 64 bit).
[[nodiscard]] std::string config_hash(const std::string& section, AnyConfig& config);

/// The configuration of one process where several share a program: its section of the file (no file: the defaults),
/// then the assignments SECTION.KEY=VALUE for its section.
template <class Config>
[[nodiscard]] Config config_of(const std::string& section, SectionNames sections, const std::string& file,
                               const std::vector<std::string>& assignments) {
  ConfigOf<Config> config;
  if (!file.empty()) load_config(file, section, sections, config);
  set_section_values(section, assignments, config);
  return config.value;
}

}  // namespace curbstone
