#include "drivers/encoder/encoder_node.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <stdexcept>
#include <tuple>
#include <utility>

#include "common/time/microseconds.hpp"
#include "drivers/encoder/drive_faults.hpp"

namespace curbstone::encoder {

namespace {

constexpr std::int64_t kOldSpeeds = 500'000;  // us

canopen::WheelDrive::Settings drive_settings(const EncoderConfig& config) {
  canopen::WheelDrive::Settings settings;
  settings.node = static_cast<std::uint8_t>(config.node);
  settings.configure = config.configure && config.interface != Interface::kFile;
  settings.period = std::int64_t{config.period} * 1000;
  settings.event_timer_unit = std::llround(config.event_timer_unit * 1e3);
  settings.patience = microseconds(config.silence);
  return settings;
}

WheelCounter::Settings odometer_settings(const EncoderConfig& config) {
  return {config.counts_per_revolution, {config.invert_left, config.invert_right}, config.max_speed};
}

std::optional<signals::WheelSignals> signals_of(const EncoderConfig& config) {
  if (config.signals.kind == SignalKind::kNone) return {};
  const auto parse = [&](const char* key, const std::string& text) {
    try {
      const auto signal = signals::CanSignal::parse(text);
      if (config.signals.kind == SignalKind::kCounts && (signal.factor != 1 || signal.offset != 0))
        throw std::runtime_error("counts have no factor and no offset: set counts_per_revolution");
      return signal;
    } catch (const std::runtime_error& error) {
      throw ConfigError(fmt::format("encoder.signals.{}: {}", key, error.what()));
    }
  };
  const auto left = parse("left", config.signals.left);
  const auto right = parse("right", config.signals.right);
  const double most = config.max_speed / (2 * std::numbers::pi) * config.counts_per_revolution * config.period * 1e-3;
  for (const auto& [key, signal, text] :
       {std::tuple{"left", &left, &config.signals.left}, std::tuple{"right", &right, &config.signals.right}}) {
    if (config.signals.kind == SignalKind::kCounts && most >= signal->half_range()) {
      throw ConfigError(
          fmt::format("encoder.signals.{}: \"{}\": a wheel at max_speed makes {:.0f} counts in a period, which {} bits "
                      "cannot tell from the way back: set max_speed to that of the vehicle",
                      key, *text, most, signal->length));
    }
  }
  if (left.overlaps(right)) {
    throw ConfigError(fmt::format("encoder.signals.right: \"{}\": it has bits of encoder.signals.left, \"{}\"",
                                  config.signals.right, config.signals.left));
  }
  return signals::WheelSignals(left, right);
}

}  // namespace

std::vector<std::uint32_t> can_ids(const EncoderConfig& config) {
  if (const auto signals = signals_of(config)) return signals->ids();
  return canopen::WheelDrive::ids(static_cast<std::uint8_t>(config.node));
}

EncoderNode::EncoderNode(const EncoderConfig& config, Publisher& bus, Send send)
    : config_(config),
      drive_(drive_settings(config),
             {std::move(send),
              [this](std::int64_t utime, std::array<std::int32_t, 2> counts) { on_counts(utime, counts); },
              [this] {
                drop_held();
                forget_counts();
                odometer_.restart_near_zero();
                stuck_.restart();
              },
              [this] {
                drop_held();
                forget_counts();
                clock_.restart();
              }}),
      signals_(signals_of(config)),
      odometer_(odometer_settings(config)),
      speedometer_(odometer_settings(config), signals_ ? signals_->resolution() : 0),
      stuck_(config.counts_per_revolution),
      senders_(config.counts_per_revolution, config.max_speed),
      first_period_(std::int64_t{config.period} * 1000),
      clock_(std::int64_t{config.period} * 1000),
      output_(bus) {}

void EncoderNode::on_frame(std::int64_t receive_utime, const can::CanFrame& frame) {
  counters_.add("frames");
  refusal_ = nullptr;
  last_frame_ = receive_utime;
  if (signals_) {
    on_signals(receive_utime, frame);
  } else {
    drive_.on_frame(receive_utime, frame);
    if (drive_.refusal() != nullptr) refusal_ = drive_.refusal();
  }
  if (refusal_ != nullptr) {
    share_.refused(receive_utime, refusal_);
  } else {
    share_.used(receive_utime);
  }
}

void EncoderNode::restart_counting() {
  drop_held();
  forget_counts();
  odometer_.restart();
  stuck_.restart();
  clock_.restart();
}

void EncoderNode::forget_counts() {
  last_counts_.reset();
  last_step_.reset();
}

void EncoderNode::on_counts(std::int64_t receive_utime, const WheelCounter::Raw& counts) {
  const bool had_two_senders = senders_.detected();
  if (senders_.add(counts)) {
    last_received_ = receive_utime;
    return counters_.add("withheld.two_senders");
  }
  if (had_two_senders) restart_counting();
  // The clock counts samples: a repeated frame would shift it by a period. While samples are held the odometer does not
  // know yet how fast the wheels turn. Before the second sample nothing does.
  const double period = static_cast<double>(clock_.period()) * 1e-6;
  const bool at_once = receive_utime - last_received_ < clock_.period() / 4;
  const bool fast = odometer_.turns_fast(period) || !last_step_ || *last_step_ >= WheelCounter::kTooFast;
  if (at_once && counts == last_counts_ && fast) {
    if (!last_step_) last_step_ = 0;
    counters_.add("refused.repeated");
    refusal_ = "refused.repeated";
    return;
  }
  // Another node with the same id sends at any time: the clock must not count its frames either.
  if (clock_.is_early(receive_utime) &&
      !odometer_.is_possible(counts, period * static_cast<double>(waiting_.size() + 1))) {
    counters_.add("refused.jump");
    refusal_ = "refused.jump";
    return;
  }
  if (last_counts_) last_step_ = WheelCounter::step(*last_counts_, counts);
  last_counts_ = counts;
  const canopen::DriveStatus& status = drive_.status();
  std::optional<StuckCounts::Speeds> speeds;
  if (status.word_utime != 0 && receive_utime - status.word_utime <= kOldSpeeds) speeds = status.speed;
  stuck_.add(receive_utime, counts, speeds);
  on_sample(
      receive_utime,
      [this, counts](int least, int most) {
        return odometer_.likely_periods(counts, least, most, static_cast<double>(clock_.period()) * 1e-6);
      },
      [this, counts](double elapsed) { return odometer_.update(counts, elapsed); });
}

void EncoderNode::on_signals(std::int64_t receive_utime, const can::CanFrame& frame) {
  const std::int64_t refused = signals_->counters()["refused.length"];
  const auto values = signals_->on_frame(receive_utime, frame);
  if (signals_->counters()["refused.length"] != refused) refusal_ = "refused.length";
  if (!values) return;
  // No message reports that the counting node has lost power: after a silence it may count from 0. The first sample
  // then has no speed.
  const std::int64_t gap = receive_utime - last_received_;
  const bool replugged = std::exchange(replugged_, false);
  const bool first = last_received_ == 0 || gap > microseconds(config_.silence) || replugged || may_have_wrapped(gap);
  if (config_.signals.kind == SignalKind::kSpeeds) {
    if (first) speedometer_.restart();
    return on_sample(
        receive_utime, [](int, int) { return std::nullopt; },
        [this, speeds = values->values](double elapsed) { return speedometer_.update(speeds, elapsed); });
  }
  if (!first) return on_counts(receive_utime, values->counts);
  if (last_received_ != 0 && !replugged) counters_.add("counts_restarted");
  drop_held();
  odometer_.restart();
  clock_.restart();
  (void)odometer_.update(values->counts, 0);
  last_received_ = last_stamped_ = receive_utime;
}

/// Whether a counter may have gone half around since the previous frame, `gap` us ago: frames were lost, or are late.
bool EncoderNode::may_have_wrapped(std::int64_t gap) const {
  if (config_.signals.kind != SignalKind::kCounts || 2 * gap <= 3 * clock_.period()) return false;
  return odometer_.most_turned(static_cast<double>(gap) * 1e-6) >= signals_->half_range();
}

void EncoderNode::on_sample(std::int64_t receive_utime, PeriodClock::Evidence evidence, Update update) {
  if (!period_known_ && receive_utime - last_received_ > PeriodClock::kMaxGap) drop_held();
  last_received_ = receive_utime;
  const auto& status = drive_.status();
  Arrived arrived{receive_utime, std::move(update), status.faults, status.enabled(receive_utime), stuck_.all_stuck()};
  for (std::size_t i = 0; i < 2; ++i) {
    if (!stuck_.stuck(i)) continue;
    arrived.faults[i] |= StuckCounts::kFault;
    arrived.enabled = false;
  }
  if (period_known_) return stamp(std::move(arrived), evidence);
  held_.push_back({std::move(arrived), std::move(evidence)});
  if (const auto period = first_period_.add(receive_utime)) {
    clock_.set_period(*period);
    release_held();
  }
}

void EncoderNode::release_held() {
  period_known_ = true;
  for (HeldSample& held : std::exchange(held_, {})) stamp(std::move(held.arrived), held.evidence);
}

/// Drops samples that were interrupted before their period was known: their times are unknown too.
void EncoderNode::drop_held() {
  if (!held_.empty()) counters_.add("withheld.unsure", static_cast<std::int64_t>(held_.size()));
  held_.clear();
  first_period_.restart();
}

void EncoderNode::stamp(Arrived arrived, const PeriodClock::Evidence& evidence) {
  const std::int64_t received = arrived.receive_utime;
  waiting_.push_back(std::move(arrived));
  for (const PeriodClock::Stamp& stamp : clock_.stamp(received, evidence)) {
    on_stamp(received, waiting_.front(), stamp);
    waiting_.pop_front();
  }
}

void EncoderNode::on_stamp(std::int64_t now, const Arrived& arrived, const PeriodClock::Stamp& stamp) {
  // Speeds use the drive's own periods: a correction of the clock's offset is no change of speed.
  std::int64_t passed = stamp.restarted ? arrived.receive_utime - last_stamped_ : stamp.steps * clock_.period();
  if (passed < 0) passed = clock_.period();  // the host's clock was set back
  const double elapsed = static_cast<double>(passed) * 1e-6;
  if (stamp.sure || stamp.steps > 0) last_stamped_ = arrived.receive_utime;
  if (!stamp.sure) {
    counters_.add("withheld.unsure");
    odometer_.skip(elapsed);
    speedometer_.skip(elapsed);
    return;
  }
  if (stamp.lost > 0) counters_.add("lost.samples", stamp.lost);

  const auto publish_it = [&](wheels_t& message) { output_.publish(message, now); };
  if (stamp.restarted) {
    start_.release(publish_it);
    start_.begin(arrived.receive_utime);
    output_.restart(stamp.utime);
  }
  start_.move_earlier(stamp.earlier);
  const Sample sample = arrived.update(elapsed);
  if (!sample) {
    refusal_ = config_.signals.kind == SignalKind::kSpeeds ? speedometer_.refusal() : odometer_.refusal();
    return;
  }
  if (arrived.stuck) return counters_.add("withheld.stuck");
  wheels_t message = WheelsOutput::message(*sample, stamp.utime);
  for (std::size_t i = 0; i < 2; ++i) message.faults[i] = arrived.faults[i];
  message.enabled = arrived.enabled;
  start_.pass(std::move(message), arrived.receive_utime, publish_it);
}

void EncoderNode::finish() {
  release_held();
  start_.release([this](wheels_t& message) { output_.publish(message, last_received_); });
  if (!waiting_.empty()) counters_.add("withheld.unsure", static_cast<std::int64_t>(waiting_.size()));
  waiting_.clear();
}

void EncoderNode::on_link(std::int64_t now, link::LinkState state, const std::string& why) {
  const bool up = state == link::LinkState::kUp;
  const bool reopened = up && counters_["link.lost"] > 0;
  if (reopened) counters_.add("link.reopened");
  if (reopened && !link_fault_.empty()) {  // another drive may have been plugged in
    counters_.add("counts_restarted");
    restart_counting();
    replugged_ = true;
  }
  if (!up && link_fault_.empty() && counters_["frames"] > 0) counters_.add("link.lost");
  link_fault_ = up ? "" : why;
  if (up && !signals_) drive_.start(now);
}

/// A step forward looks like a delay, which the clock's window would accept for seconds.
void EncoderNode::clock_was_set(std::int64_t by) {
  if (by <= 0) return;  // frames with earlier times of receipt show it
  counters_.add("clock_jumps");
  drop_held();
  clock_.restart();
}

void EncoderNode::tick(std::int64_t now) {
  if (config_.interface == Interface::kFile) now = last_frame_;
  if (now == 0) return;
  if (now_ == 0) began_ = now;
  now_ = now;
  share_.tick(now);
  if (link_fault_.empty() && !signals_) drive_.tick(now);
}

NodeReport EncoderNode::report() const {
  NodeReport report;
  report.counters = counters_;
  const Counters drive = drive_.counters();
  const Counters none;
  const Counters& signals = signals_ ? signals_->counters() : none;
  for (const Counters* more : {&drive, &odometer_.counters(), &speedometer_.counters(), &signals})
    report.counters.add(*more);
  output_.report(report);

  if (!link_fault_.empty()) report.faults.push_back(link_fault_);
  const double silent = static_cast<double>(now_ - (last_received_ != 0 ? last_received_ : began_)) * 1e-6;
  if (link_fault_.empty() && silent > config_.silence)
    report.faults.push_back(
        fmt::format("no positions from the drive for {:.0f} s{}", silent, signals_ ? "" : drive_.heard_instead()));
  if (link_fault_.empty() && !signals_) {
    for (std::string& fault : drive_.faults()) report.faults.push_back(std::move(fault));
  }
  if (silent <= config_.silence) {
    for (std::string& fault : stuck_.faults()) report.faults.push_back(std::move(fault));
  }
  if (share_.fault()) report.faults.push_back(*share_.fault());
  if (senders_.detected()) {
    report.faults.push_back(fmt::format(
        "two nodes send positions as one, none is used: {}",
        signals_ ? "two senders of one CAN id?" : fmt::format("another drive with CAN node id {}?", config_.node)));
  }
  if (link_fault_.empty()) add_wheel_faults(report, drive_.status().faults);
  if (clock_.period() != std::int64_t{config_.period} * 1000) {
    report.faults.push_back(fmt::format("the drive sends every {:.1f} ms, {} ms was asked for: check event_timer_unit",
                                        static_cast<double>(clock_.period()) * 1e-3, config_.period));
  }
  add_encoder_lines_fault(report, drive_.encoder_lines().value_or(0), config_);
  if (add_report_) add_report_(report);
  return report;
}

}  // namespace curbstone::encoder
