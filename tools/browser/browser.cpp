#include "tools/browser/browser.hpp"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <stdlib.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <boost/beast/core/detail/base64.hpp>
#include <chrono>
#include <fstream>
#include <stdexcept>
#include <thread>

namespace curbstone::browser {
namespace {

using nlohmann::json;
using Clock = std::chrono::steady_clock;

constexpr const char* kProgram = "/usr/bin/chromium-headless-shell";
constexpr auto kPatience = std::chrono::minutes(1);
constexpr int kRound = 5;  // ms between two calls of `meanwhile`

/// A command that the browser refused, with its error code.
class DevToolsError : public std::runtime_error {
 public:
  static constexpr int kNotNow = -32000;  ///< the page was left, or has no script context yet
  DevToolsError(const std::string& what, int code) : std::runtime_error(what), code_(code) {}
  [[nodiscard]] int code() const { return code_; }

 private:
  int code_;
};

/// Chromium reads commands at descriptor 3 and writes responses to 4, each message ended by a zero byte.
int start(int orders, int answers, const std::string& profile) {
  const std::string user_data = "--user-data-dir=" + profile;
  const int process = fork();
  if (process != 0) return process;
  setpgid(0, 0);
  // Duplicated twice, because either may already be at 3 or 4.
  const int in = fcntl(orders, F_DUPFD, 10), out = fcntl(answers, F_DUPFD, 10);
  dup2(in, 3);
  dup2(out, 4);
  const int log = ::open((profile + "/log").c_str(), O_WRONLY | O_CREAT, 0644);
  dup2(log, STDOUT_FILENO);
  dup2(log, STDERR_FILENO);
  execl(kProgram, kProgram, "--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
        "--disable-dev-shm-usage", "--hide-scrollbars", "--remote-debugging-pipe", user_data.c_str(), "about:blank",
        nullptr);
  _exit(127);
}

/// Creates a new empty folder.
std::filesystem::path new_folder() {
  std::string pattern = (std::filesystem::temp_directory_path() / "curbstone_browser_XXXXXX").string();
  if (mkdtemp(pattern.data()) == nullptr) throw std::runtime_error("mkdtemp " + pattern);
  return pattern;
}

}  // namespace

bool Browser::is_installed() {
  return access(kProgram, X_OK) == 0;
}

Browser::Browser(std::function<void()> meanwhile, int width, int height)
    : folder_(new_folder()), meanwhile_(std::move(meanwhile)) {
  std::array<int, 2> orders{}, answers{};
  if (pipe2(orders.data(), O_CLOEXEC) != 0 || pipe2(answers.data(), O_CLOEXEC) != 0) throw std::runtime_error("pipe2");
  process_ = start(orders[0], answers[1], folder_.string());
  ::close(orders[0]);
  ::close(answers[1]);
  to_browser_ = orders[1];
  from_browser_ = answers[0];
  const json page = call("Target.createTarget", {{"url", "about:blank"}});
  session_ = call("Target.attachToTarget", {{"targetId", page["targetId"]}, {"flatten", true}})["sessionId"];
  for (const char* domain : {"Page", "Runtime", "Log"}) call(std::string(domain) + ".enable");
  // Without a GPU drawing is slow, so transitions are switched off.
  prefer({{"prefers-reduced-motion", "reduce"}});
  resize(width, height);
}

Browser::~Browser() {
  ::close(to_browser_);
  ::close(from_browser_);
  kill(-process_, SIGKILL);
  waitpid(process_, nullptr, 0);
  std::error_code ignored;
  std::filesystem::remove_all(folder_, ignored);
}

void Browser::resize(int width, int height, bool touch) {
  call("Emulation.setDeviceMetricsOverride",
       {{"width", width}, {"height", height}, {"deviceScaleFactor", 1}, {"mobile", touch}});
  call("Emulation.setTouchEmulationEnabled", {{"enabled", touch}});
}

void Browser::open(const std::string& url) {
  call("Page.navigate", {{"url", "about:blank"}});  // otherwise a new fragment alone would load nothing
  const json answer = call("Page.navigate", {{"url", url}});
  if (answer.contains("errorText")) throw std::runtime_error(url + ": " + answer["errorText"].get<std::string>());
}

void Browser::at_the_beginning(const std::string& script) {
  call("Page.addScriptToEvaluateOnNewDocument", {{"source", script}});
}

void Browser::prefer(const std::vector<std::pair<std::string, std::string>>& features) {
  json list = json::array();
  for (const auto& [name, value] : features) list.push_back({{"name", name}, {"value", value}});
  call("Emulation.setEmulatedMedia", {{"features", list}});
}

json Browser::evaluate(const std::string& expression) {
  const json answer =
      call("Runtime.evaluate", {{"expression", expression}, {"returnByValue", true}, {"awaitPromise", true}});
  if (answer.contains("exceptionDetails"))
    throw std::runtime_error(expression + ": " + answer["exceptionDetails"].dump());
  return answer["result"].contains("value") ? answer["result"]["value"] : json();
}

bool Browser::comes_to(const std::string& expression, double seconds) {
  const auto end = Clock::now() + std::chrono::duration<double>(seconds);
  do {
    // While a page is loading, parts of the expression may not exist yet.
    try {
      if (evaluate("(() => { try { return !!(" + expression + "); } catch { return false; } })()") == true) return true;
    } catch (const DevToolsError& error) {  // the same for a page that is being left
      if (error.code() != DevToolsError::kNotNow) throw;
    }
    pass(0.02);
  } while (Clock::now() < end);
  return false;
}

void Browser::pass(double seconds) {
  const auto end = Clock::now() + std::chrono::duration<double>(seconds);
  while (Clock::now() < end) {
    meanwhile_();
    std::this_thread::sleep_for(std::chrono::milliseconds(kRound));
  }
}

void Browser::mouse(const std::string& type, double x, double y, int buttons, int clicks, const char* button) {
  call("Input.dispatchMouseEvent", {{"type", type},
                                    {"x", x},
                                    {"y", y},
                                    {"buttons", buttons},
                                    {"button", clicks > 0 || buttons > 0 ? button : "none"},
                                    {"clickCount", clicks}});
}

void Browser::click(double x, double y) {
  mouse("mouseMoved", x, y);
  mouse("mousePressed", x, y, 1, 1);
  mouse("mouseReleased", x, y, 0, 1);
}

void Browser::drag(double from_x, double from_y, double to_x, double to_y, bool right_button) {
  const char* button = right_button ? "right" : "left";
  const int buttons = right_button ? 2 : 1;
  mouse("mouseMoved", from_x, from_y);
  mouse("mousePressed", from_x, from_y, buttons, 1, button);
  for (const double share : {0.2, 0.6, 1.0})
    mouse("mouseMoved", from_x + share * (to_x - from_x), from_y + share * (to_y - from_y), buttons, 0, button);
  mouse("mouseReleased", to_x, to_y, 0, 1, button);
}

void Browser::touch(const Finger& one, const Finger& other) {
  const auto at = [](const Finger& f, double share, int id) {
    return json{
        {"x", f.from_x + share * (f.to_x - f.from_x)}, {"y", f.from_y + share * (f.to_y - f.from_y)}, {"id", id}};
  };
  for (const double share : {0.0, 0.2, 0.4, 0.6, 0.8, 1.0})
    call("Input.dispatchTouchEvent", {{"type", share == 0 ? "touchStart" : "touchMove"},
                                      {"touchPoints", {at(one, share, 0), at(other, share, 1)}}});
  call("Input.dispatchTouchEvent", {{"type", "touchEnd"}, {"touchPoints", json::array()}});
}

void Browser::swipe(const Finger& finger) {
  for (int step = 0; step <= 8; ++step) {
    const double share = step / 8.0;
    const json at = {{"x", finger.from_x + share * (finger.to_x - finger.from_x)},
                     {"y", finger.from_y + share * (finger.to_y - finger.from_y)},
                     {"id", 0}};
    call("Input.dispatchTouchEvent",
         {{"type", step == 0 ? "touchStart" : "touchMove"}, {"touchPoints", json::array({at})}});
  }
  call("Input.dispatchTouchEvent", {{"type", "touchEnd"}, {"touchPoints", json::array()}});
}

void Browser::hold(double x, double y, double seconds) {
  call("Input.dispatchTouchEvent",
       {{"type", "touchStart"}, {"touchPoints", json::array({{{"x", x}, {"y", y}, {"id", 0}}})}});
  pass(seconds);
  call("Input.dispatchTouchEvent", {{"type", "touchEnd"}, {"touchPoints", json::array()}});
}

void Browser::press(char key) {
  const std::string text(1, key);
  call("Input.dispatchKeyEvent", {{"type", "keyDown"}, {"key", text}, {"text", text}});
  call("Input.dispatchKeyEvent", {{"type", "keyUp"}, {"key", text}});
}

void Browser::press(const std::string& key) {
  call("Input.dispatchKeyEvent", {{"type", "rawKeyDown"}, {"key", key}});
  call("Input.dispatchKeyEvent", {{"type", "keyUp"}, {"key", key}});
}

double Browser::memory() {
  call("HeapProfiler.enable");
  for (int i = 0; i < 2; ++i) call("HeapProfiler.collectGarbage");  // frees first a buffer's owner, then the buffer
  const json usage = call("Runtime.getHeapUsage");
  return usage["usedSize"].get<double>() + usage.value("backingStorageSize", 0.0);
}

void Browser::save_to(const std::string& folder) {
  call("Page.setDownloadBehavior", {{"behavior", "allow"}, {"downloadPath", folder}});
}

std::string Browser::png() {
  // A drawn picture is on the screen two animation frames later: without a graphics card another process draws it.
  evaluate("new Promise(done => requestAnimationFrame(() => requestAnimationFrame(() => done(true))))");
  namespace base64 = boost::beast::detail::base64;
  const std::string text = call("Page.captureScreenshot", {{"format", "png"}})["data"];
  std::string bytes(base64::decoded_size(text.size()), '\0');
  bytes.resize(base64::decode(bytes.data(), text.data(), text.size()).first);
  return bytes;
}

Picture Browser::picture() {
  return Picture(png());
}

void Browser::save_picture(const std::string& file) {
  std::ofstream(file, std::ios::binary) << png();
}

json Browser::call(const std::string& method, json parameters) {
  json order{{"id", ++last_id_}, {"method", method}, {"params", std::move(parameters)}};
  if (!session_.empty()) order["sessionId"] = session_;
  std::string bytes = order.dump();
  bytes.push_back('\0');
  for (std::size_t sent = 0; sent < bytes.size();) {
    const ssize_t n = ::write(to_browser_, bytes.data() + sent, bytes.size() - sent);
    if (n <= 0) throw std::runtime_error("the browser has ended");
    sent += static_cast<std::size_t>(n);
  }
  const json answer = receive(last_id_);
  if (answer.contains("error"))
    throw DevToolsError(method + ": " + answer["error"].dump(), answer["error"].value("code", 0));
  return answer["result"];
}

json Browser::receive(int id) {
  const auto end = Clock::now() + kPatience;
  while (Clock::now() < end) {
    for (std::size_t stop = heard_.find('\0'); stop != std::string::npos; stop = heard_.find('\0')) {
      const json message = json::parse(heard_.substr(0, stop));
      heard_.erase(0, stop + 1);
      if (message.value("id", -1) == id) return message;
      note(message);
    }
    meanwhile_();
    pollfd ready{.fd = from_browser_, .events = POLLIN, .revents = 0};
    if (poll(&ready, 1, kRound) <= 0) continue;
    std::array<char, 65536> bytes{};
    const ssize_t n = ::read(from_browser_, bytes.data(), bytes.size());
    if (n <= 0) throw std::runtime_error("the browser has ended");
    heard_.append(bytes.data(), static_cast<std::size_t>(n));
  }
  throw std::runtime_error("the browser answers nothing");
}

void Browser::note(const json& event) {
  const std::string method = event.value("method", "");
  if (method == "Runtime.exceptionThrown") complaints_.push_back(event["params"]["exceptionDetails"].dump());
  if (method == "Log.entryAdded") {
    const json& entry = event["params"]["entry"];
    // Some tests stop the server on purpose, so network errors do not count.
    if (entry.value("level", "") == "error" && entry.value("source", "") != "network")
      complaints_.push_back(entry.value("text", ""));
  }
}

}  // namespace curbstone::browser
