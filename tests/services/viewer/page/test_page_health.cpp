// The board of the processes: alarms of a live run, the states at the end of a log, and the sum of all.
#include "tests/services/viewer/page/page_on_a_bus.hpp"

namespace curbstone::viewer {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

class PageHealth : public PageOnABus {
 protected:
  void send_status(const std::string& service, const std::string& fault, std::int64_t cpu_time = 0,
                   std::int64_t memory = 0) {
    service_status_t status{};
    status.service = service;
    status.pid = 7;
    status.uptime = ++uptime_ * 1'000'000;
    status.cpu_time = cpu_time;
    status.memory = memory;
    status.latency_p50 = status.latency_p99 = 0.01F;
    if (!fault.empty()) status.fault = {fault};
    status.num_faults = static_cast<std::int32_t>(status.fault.size());
    send("SERVICE_STATUS", status);
  }
  /// The sensors have ended before the services.
  void end_a_drive() {
    put_roads(-1, 1);
    open("theme=light");
    send_status("ekf", "");
    send_status("mapper", "no LIDAR_POINTS for 2 s");
    ASSERT_TRUE(shows("#verdict", "1 with faults"));
  }
  std::string class_of(const std::string& selector) {
    return browser->evaluate("document.querySelector('" + selector + "').className");
  }

 private:
  std::int64_t uptime_ = 0;
};

TEST_F(PageHealth, AtTheEndOfALogStatesAreThoseOfThenAndNoAlarms) {
  end_a_drive();
  EXPECT_EQ(class_of("#verdict"), "bad") << "of a live run";
  send_playback(false, true);
  ASSERT_TRUE(shows("#verdict", "at the end of the log"));
  EXPECT_EQ(class_of("#verdict"), "");
  EXPECT_EQ(class_of("#services li:last-child"), "over");
  EXPECT_THAT(text_of("#services"), HasSubstr("no LIDAR_POINTS for 2 s")) << "it can still be read";
  EXPECT_EQ(browser->evaluate("document.querySelectorAll('#services .words').length"), 0);
  browser->pass(3.5);
  EXPECT_THAT(text_of("#services"), Not(HasSubstr("silent"))) << "nobody can be heard";
  EXPECT_THAT(text_of("#summary"), Not(HasSubstr("faults")));
  keep_picture("end_of_a_log");
}

TEST_F(PageHealth, TheTimeLineOfALogSaysHowLongItIs) {
  put_roads(-1, 1);
  open("theme=light");
  send_playback();
  EXPECT_TRUE(shows("#elapsed", "0:12 / 0:30")) << text_of("#elapsed");
}

TEST_F(PageHealth, AtTheEndOfALogThereIsNoLatency) {
  put_roads(-1, 1);
  open("theme=light");
  for (int i = 0; i < 5; ++i) {
    put(tile_of(0, 0, i % 2 == 0 ? semantic_tile_t::ROAD : semantic_tile_t::WALL));
    browser->pass(0.2);
  }
  send_playback(false, false);
  ASSERT_TRUE(shows("#latency", "from sensor to screen"));
  send_playback(false, true);
  EXPECT_TRUE(browser->comes_to("document.getElementById('latency').textContent === ''"));
}

TEST_F(PageHealth, WhileALogStandsNobodyIsSilentButAFaultIsOne) {
  end_a_drive();
  send_playback(true, false);
  browser->pass(4);
  EXPECT_THAT(text_of("#verdict"), HasSubstr("1 with faults"));
  EXPECT_THAT(text_of("#services"), Not(HasSubstr("silent")));
}

TEST_F(PageHealth, InALiveRunAProcessThatIsNotHeardIsSilent) {
  end_a_drive();
  EXPECT_TRUE(browser->comes_to("document.querySelectorAll('#services .silent').length === 2"));
  EXPECT_TRUE(shows("#verdict", "1 with faults")) << "which stays an alarm";
  EXPECT_TRUE(shows("#alarm", "no process is heard")) << "it is not that one of them ended";
}

TEST_F(PageHealth, AFaultIsInWordsInTheBarThoughThePanelIsAway) {
  put_roads(-1, 1);
  open("theme=light&panel=0");
  const auto come_to_show = [&](const std::string& selector, const std::string& words) {
    for (int second = 0; second < 10; ++second) {
      send_status("ekf", "IMU: silent for 2 s");
      send_status("imu", "no data for 2 s");  // the cause
      send_status("mapper", "");
      if (shows(selector, words, 1)) return true;
    }
    return false;
  };
  EXPECT_TRUE(come_to_show("#alarm", "imu: no data for 2 s (and 1 more)")) << text_of("#bar");
  keep_picture("alarm");
  browser->evaluate("document.getElementById('alarm').click()");
  EXPECT_TRUE(browser->comes_to("document.querySelector('#services').checkVisibility()", 5));
  browser->resize(390, 844, true);
  EXPECT_TRUE(come_to_show("#summary", "imu: no data for 2 s")) << "a phone's is on the handle of the sheet";
  send_playback(false, true);
  EXPECT_TRUE(browser->comes_to("document.getElementById('alarm').hidden"));
}

TEST_F(PageHealth, NamesAreWholeHoweverWideTheirFigures) {
  put_roads(-1, 1);
  open("theme=light");
  for (const std::int64_t second : {1, 2})
    for (const char* name : {"tensor_voting:1", "semantic_map"}) send_status(name, "", 900'000 * second, 160'000'000);
  ASSERT_TRUE(shows("#total", "All 2"));
  EXPECT_EQ(browser->evaluate(
                "[...document.querySelectorAll('#services b')].filter(b => b.scrollWidth > b.clientWidth).map(b => "
                "b.innerText)"),
            nlohmann::json::array());
}

TEST_F(PageHealth, AViewerAloneIsNotAllWell) {
  bus_is_alive = false;
  browser->open(address);
  send_status("viewer", "");
  ASSERT_TRUE(shows("#services", "viewer"));
  EXPECT_THAT(text_of("#verdict"), Not(HasSubstr("all well")));
}

TEST_F(PageHealth, SumsUpTheWholeStack) {
  put_roads(-1, 1);
  open("theme=light");
  for (const std::int64_t second : {1, 2}) {
    send_status("ekf", "", 250'000 * second, 40'000'000);
    send_status("mapper", "", 1'500'000 * second, 160'000'000);
  }
  // Two of the statuses are of two seconds of uptime each.
  ASSERT_TRUE(shows("#total", "All 2")) << text_of("#health");
  EXPECT_THAT(text_of("#total"), HasSubstr("88 % of a core"));
  EXPECT_THAT(text_of("#total"), HasSubstr("200 MB"));
  browser->evaluate("document.getElementById('total').scrollIntoView()");
  keep_picture("total");
}

}  // namespace
}  // namespace curbstone::viewer
