#pragma once

#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tools/browser/picture.hpp"

namespace curbstone::browser {

/// Debian's Chromium without a window, driven by the DevTools protocol over a pipe (no node, no port). One page.
/// While it waits for the browser it calls `meanwhile` about each 5 ms: there the caller lets its services go on.
/// One thread. What goes wrong is a std::runtime_error, a browser that answers nothing for a minute included.
class Browser {
 public:
  /// Whether this machine has one.
  [[nodiscard]] static bool is_installed();

  explicit Browser(std::function<void()> meanwhile, int width = 1280, int height = 800);
  ~Browser();
  Browser(const Browser&) = delete;
  Browser& operator=(const Browser&) = delete;

  /// CSS pixels; `touch`: a phone or a tablet.
  void resize(int width, int height, bool touch = false);
  void open(const std::string& url);
  /// What the expression is, promises awaited. An exception in it is thrown here, too.
  nlohmann::json evaluate(const std::string& expression);
  /// Until the expression is true; false when it does not become so.
  bool comes_to(const std::string& expression, double seconds = 30);
  /// Lets that much time pass.
  void pass(double seconds);

  void move(double x, double y) { mouse("mouseMoved", x, y); }
  void click(double x, double y);
  void drag(double from_x, double from_y, double to_x, double to_y, bool right_button = false);
  /// Two fingers at a time, from place to place; CSS pixels.
  struct Finger {
    double from_x, from_y, to_x, to_y;
  };
  void touch(const Finger& one, const Finger& other);
  /// One finger that rests at a place and leaves it again.
  void hold(double x, double y, double seconds);
  /// What the page saves goes to this folder.
  void save_to(const std::string& folder);
  /// A key that writes a letter or a sign.
  void press(char key);
  /// One that does not, by its name: "ArrowUp", "Enter".
  void press(const std::string& key);

  /// Bytes that the page's scripts hold, buffers included, after what is not used any more has been given back.
  double memory();

  [[nodiscard]] Picture picture();
  /// As a file, for people.
  void save_picture(const std::string& file);
  /// Exceptions of the page and what its security policy refused.
  [[nodiscard]] const std::vector<std::string>& complaints() const { return complaints_; }

 private:
  nlohmann::json call(const std::string& method, nlohmann::json parameters = nlohmann::json::object());
  void mouse(const std::string& type, double x, double y, int buttons = 0, int clicks = 0, const char* button = "left");
  nlohmann::json hear(int id);
  void note(const nlohmann::json& event);
  std::string png();

  std::filesystem::path folder_;  // of its profile; goes with it
  std::function<void()> meanwhile_;
  int to_browser_ = -1;
  int from_browser_ = -1;
  int process_ = -1;
  int last_id_ = 0;
  std::string session_;
  std::string heard_;  // bytes that make no whole message yet
  std::vector<std::string> complaints_;
};

}  // namespace curbstone::browser
