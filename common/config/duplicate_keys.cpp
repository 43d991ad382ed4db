#include "common/config/duplicate_keys.hpp"

#include <fmt/format.h>
#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/yaml.h>

#include <map>
#include <sstream>
#include <vector>

#include "common/config/config.hpp"

namespace curbstone {

namespace {

/// Follows the parser's events, not the nodes made from them: with an alias, a node can contain itself.
class DuplicateKeyFinder final : public YAML::EventHandler {
 public:
  explicit DuplicateKeyFinder(std::string name) : name_(std::move(name)) {}

  void OnDocumentStart(const YAML::Mark&) override {}
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark&, YAML::anchor_t) override { on_node(); }
  void OnAlias(const YAML::Mark&, YAML::anchor_t) override { on_node(); }
  void OnScalar(const YAML::Mark& mark, const std::string&, YAML::anchor_t, const std::string& value) override {
    if (on_node()) on_key(value, mark.line + 1);
  }
  void OnSequenceStart(const YAML::Mark&, const std::string&, YAML::anchor_t, YAML::EmitterStyle::value) override {
    open(false);
  }
  void OnSequenceEnd() override { levels_.pop_back(); }
  void OnMapStart(const YAML::Mark&, const std::string&, YAML::anchor_t, YAML::EmitterStyle::value) override {
    open(true);
  }
  void OnMapEnd() override { levels_.pop_back(); }

 private:
  struct Level {
    bool is_map = false;
    bool key_is_next = true;
    std::string path;                  // "mapper.icp."
    std::string key;                   // the last one
    std::map<std::string, int> lines;  // of the keys so far
  };

  /// Called when a node begins. Returns whether it is a key.
  bool on_node() {
    if (levels_.empty() || !levels_.back().is_map) return false;
    Level& map = levels_.back();
    map.key_is_next = !map.key_is_next;
    return !map.key_is_next;
  }
  void on_key(const std::string& key, int line) {
    Level& map = levels_.back();
    const auto [first, is_new] = map.lines.emplace(key, line);
    if (!is_new)
      throw ConfigError(
          fmt::format("{}:{}: {}{}: stands in line {} already", name_, line, map.path, key, first->second));
    map.key = key;
  }
  void open(bool is_map) {
    on_node();
    Level level;
    level.is_map = is_map;
    if (!levels_.empty()) {
      const Level& above = levels_.back();
      level.path = above.is_map ? above.path + above.key + "." : above.path;
    }
    levels_.push_back(std::move(level));
  }

  std::string name_;
  std::vector<Level> levels_;
};

}  // namespace

void refuse_duplicate_keys(const std::string& text, const std::string& name) {
  std::istringstream in(text);
  YAML::Parser parser(in);
  DuplicateKeyFinder finder(name);
  parser.HandleNextDocument(finder);
}

}  // namespace curbstone
