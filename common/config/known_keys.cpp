#include "common/config/known_keys.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>
#include <utility>

namespace curbstone {
namespace {

constexpr std::string_view kShared = "vehicle";  // at the top level of the file, for every process
constexpr std::size_t kMaxPlaces = 3;            // named in the message

int edit_distance(std::string_view a, std::string_view b) {
  std::vector<int> row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) row[j] = static_cast<int>(j);
  for (std::size_t i = 1; i <= a.size(); ++i) {
    int diagonal = row[0];
    row[0] = static_cast<int>(i);
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const int substituted = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({row[j] + 1, row[j - 1] + 1, substituted});
    }
  }
  return row[b.size()];
}

/// Finds the sections of a struct that have a key of this name.
class PlacesOfKey final : public ConfigVisitor {
 public:
  PlacesOfKey(std::string_view key, std::string path) : key_(key), paths_{std::move(path)} {}
  void field(const char* key, bool&, const char*) override { note(key); }
  void field(const char* key, int&, Range, const char*) override { note(key); }
  void field(const char* key, double&, Range, const char*) override { note(key); }
  void field(const char* key, std::string&, const char*) override { note(key); }
  void choice(const char* key, std::string&, const std::vector<std::string>&, const char*) override { note(key); }
  void field(const char* key, std::vector<double>&, Range, const char*, bool) override { note(key); }
  [[nodiscard]] const std::vector<std::string>& found() const { return found_; }

 protected:
  bool begin_section(const char* key, const char*) override {
    note(key);
    paths_.push_back(key == kShared ? std::string(kShared) + "." : paths_.back() + key + ".");
    return true;
  }
  void end_section() override { paths_.pop_back(); }

 private:
  void note(const char* key) {
    if (key == key_) found_.push_back(paths_.back() + key);
  }

  std::string_view key_;
  std::vector<std::string> paths_;  // of the sections with that key
  std::vector<std::string> found_;
};

/// Whether a struct has a section of this name at its top level.
class SectionFinder final : public ConfigVisitor {
 public:
  explicit SectionFinder(std::string name) : name_(std::move(name)) {}
  void field(const char*, bool&, const char*) override {}
  void field(const char*, int&, Range, const char*) override {}
  void field(const char*, double&, Range, const char*) override {}
  void field(const char*, std::string&, const char*) override {}
  void choice(const char*, std::string&, const std::vector<std::string>&, const char*) override {}
  void field(const char*, std::vector<double>&, Range, const char*, bool) override {}
  [[nodiscard]] bool found() const { return found_; }

 protected:
  bool begin_section(const char* key, const char*) override {
    found_ = found_ || key == name_;
    return false;
  }
  void end_section() override {}

 private:
  std::string name_;
  bool found_ = false;
};

}  // namespace

bool has_section(AnyConfig& config, const std::string& name) {
  SectionFinder finder(name);
  config.visit(finder);
  return finder.found();
}

std::string unknown_key(const std::string& key, const std::vector<std::string>& known, const std::string& root,
                        AnyConfig& config) {
  PlacesOfKey places(key, root);
  config.visit(places);
  if (places.found().empty() || places.found().size() > kMaxPlaces) return unknown_key(key, known);
  return fmt::format("unknown key; did you mean {}?", fmt::join(places.found(), " or "));
}

std::string unknown_key(const std::string& key, const std::vector<std::string>& known) {
  const auto nearest = std::min_element(known.begin(), known.end(), [&](const auto& a, const auto& b) {
    return edit_distance(key, a) < edit_distance(key, b);
  });
  std::string text = "unknown key";
  if (nearest != known.end()) text += fmt::format("; did you mean {}?", *nearest);
  return text;
}

}  // namespace curbstone
