#pragma once

#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "tools/browser/picture.hpp"

namespace curbstone::browser {

/// Debian's headless Chromium with one page, controlled by the DevTools protocol over a pipe (no node, no port). While
/// it waits for the browser it calls `meanwhile` about every 5 ms, so that the caller can run its services. One thread.
/// Errors are std::runtime_error, including a browser that does not respond for a minute.
class Browser {
 public:
  /// Whether this machine has Chromium.
  [[nodiscard]] static bool is_installed();

  explicit Browser(std::function<void()> meanwhile, int width = 1280, int height = 800);
  ~Browser();
  Browser(const Browser&) = delete;
  Browser& operator=(const Browser&) = delete;

  /// Size in CSS pixels; `touch`: as a phone or a tablet.
  void resize(int width, int height, bool touch = false);
  void open(const std::string& url);
  /// Runs the script in each page opened from now on, before the page's own ones.
  void at_the_beginning(const std::string& script);
  /// How the page is shown: media features as in CSS, prefers-color-scheme: dark.
  void prefer(const std::vector<std::pair<std::string, std::string>>& features);
  /// The value of the expression; promises are awaited. An exception in it is thrown here too.
  nlohmann::json evaluate(const std::string& expression);
  /// Waits until the expression is true. False on time-out.
  bool comes_to(const std::string& expression, double seconds = 30);
  /// Waits that long.
  void pass(double seconds);

  void move(double x, double y) { mouse("mouseMoved", x, y); }
  void click(double x, double y);
  void drag(double from_x, double from_y, double to_x, double to_y, bool right_button = false);
  /// Two simultaneous fingers, each from one place to another; CSS pixels.
  struct Finger {
    double from_x, from_y, to_x, to_y;
  };
  void touch(const Finger& one, const Finger& other);
  /// One finger from one place to another.
  void swipe(const Finger& finger);
  /// One finger that rests at a place and is lifted again.
  void hold(double x, double y, double seconds);
  /// Files that the page saves go to this folder.
  void save_to(const std::string& folder);
  /// Presses a key that types a character.
  void press(char key);
  /// Presses a key that types none, by its name: "ArrowUp", "Enter".
  void press(const std::string& key);

  /// Bytes held by the page's scripts, including buffers, after a garbage collection.
  double memory();

  [[nodiscard]] Picture picture();
  /// Saves the picture as a file.
  void save_picture(const std::string& file);
  /// Exceptions of the page and violations of its security policy.
  [[nodiscard]] const std::vector<std::string>& complaints() const { return complaints_; }

 private:
  nlohmann::json call(const std::string& method, nlohmann::json parameters = nlohmann::json::object());
  void mouse(const std::string& type, double x, double y, int buttons = 0, int clicks = 0, const char* button = "left");
  nlohmann::json receive(int id);
  void note(const nlohmann::json& event);
  std::string png();

  std::filesystem::path folder_;  // of its profile; removed with this object
  std::function<void()> meanwhile_;
  int to_browser_ = -1;
  int from_browser_ = -1;
  int process_ = -1;
  int last_id_ = 0;
  std::string session_;
  std::string heard_;  // bytes of an incomplete message
  std::vector<std::string> complaints_;
};

}  // namespace curbstone::browser
