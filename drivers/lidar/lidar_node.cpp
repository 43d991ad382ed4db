#include "drivers/lidar/lidar_node.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <cstdlib>
#include <stdexcept>
#include <utility>

#include "common/bus/levels.hpp"
#include "common/bus/sequence_number.hpp"
#include "common/time/microseconds.hpp"
#include "drivers/lidar/angles_file.hpp"

namespace curbstone::lidar {

using decoding::Refusal;

namespace {

constexpr std::size_t kLatencies = 750;          // one second of packets
constexpr std::size_t kMaxRawSize = 2500;        // bytes
constexpr std::int64_t kSecond = 1'000'000;      // us
constexpr double kTaiMinusUtcFrom = 36.0;        // s: 37 at present
constexpr double kTaiMinusUtcTo = 38.0;          // s
constexpr std::int64_t kNearlySet = 60'000'000;  // us: a clock this close to the host's was set, but wrongly

models::ModelSettings settings_of(const LidarConfig& config) {
  models::ModelSettings settings;
  settings.limits = {config.min_range, config.max_range, config.start_angle, config.end_angle};
  settings.distance_step = distance_step(config.distance_resolution);
  settings.wait_for_info = config.wait_for_difop;
  if (!config.angles_file.empty()) settings.angles = read_angles(config.angles_file);
  return settings;
}

/// Whether the device fired this packet: then it was received, and is not lost.
bool is_the_devices(Refusal refusal) {
  return refusal == Refusal::kBlock || refusal == Refusal::kAzimuth;
}

}  // namespace

LidarNode::LidarNode(const LidarConfig& config, Publisher& bus, HostClockCheck host_clock)
    : config_(config),
      bus_(bus),
      sent_(bus, config.channel),
      host_clock_(std::move(host_clock)),
      settings_(settings_of(config)),
      model_name_(config.model),
      model_(models::make_model(config.model, settings_)),
      clock_(config.clock, microseconds(config.clock_tolerance)),
      head_(static_cast<int>(std::lround(config.cut_angle * 100))),
      health_(point_port(config), info_port(config)),
      latency_(kLatencies) {
  message_.packet = -1;
}

void LidarNode::connect(Subscriber& bus) {
  bus.subscribe<resend_request_t>(kResendRequests, [this](const resend_request_t& m) { sent_.request(m); }, {100});
}

void LidarNode::expect_one_info() {
  settings_.only_info = true;
  vote_.expect_one_info();
  if (model_) model_ = models::make_model(config_.model, settings_);
}

void LidarNode::forget_device() {
  early_info_.clear();
  lasers_ = {};
  identity_ = {};
  if (model_) model_ = models::make_model(model_name_, settings_);
}

void LidarNode::on(const raw_packet_t& packet) {
  on_packet(packet.utime, packet.port, packet.data);
}

void LidarNode::on_packet(std::int64_t received, int port, std::span<const std::uint8_t> bytes) {
  came_since_tick_ = true;
  if (config_.publish_raw) publish_raw(received, port, bytes);
  if (!model_ && !find_model(received, bytes)) {
    counters_.add("undecided");
    return;
  }
  const models::Sender sender = models::sender_of(bytes);
  const models::PacketKind kind = model_->kind_of(sender);
  if (kind == models::PacketKind::kForeign) {
    refuse(models::counter_of(sender),
           fmt::format("{} is sending; model is {}", models::title_of(sender), model_->table().name));
    return;
  }
  const Refusal refusal = kind == models::PacketKind::kInfo ? on_info(received, bytes) : on_points(received, bytes);
  if (refusal == Refusal::kNone) {
    share_.used(now_);
  } else {
    if (is_the_devices(refusal)) order_.refused();
    if (refusal == Refusal::kLate) lost_.subtract_late();
    refuse(decoding::counter_of(refusal), remedy(refusal, model_->table()));
  }
  send_ready();
}

bool LidarNode::find_model(std::int64_t received, std::span<const std::uint8_t> bytes) {
  const auto name = vote_.offer(bytes);
  if (!name) {
    keep_early_info(received, bytes);
    return false;
  }
  try {
    model_ = models::make_model(*name, settings_);
    model_name_ = *name;
  } catch (const std::runtime_error& error) {
    source_fault_ = error.what();  // the angles are those of another device
    return false;
  }
  print(fmt::format("model: auto: {} packets in a row are those of {}: it is {}", models::ModelVote::kAgreeing,
                    models::title_of(vote_.leading()), model_->table().name));
  for (const EarlyInfo& info : early_info_) {
    if (model_->kind_of(models::sender_of(info.bytes)) == models::PacketKind::kInfo)
      (void)model_->read_info(info.received, info.bytes);
  }
  early_info_.clear();
  return true;
}

/// The two informations that decided the model have its angles too: a capture may have no others.
void LidarNode::keep_early_info(std::int64_t received, std::span<const std::uint8_t> bytes) {
  constexpr std::size_t kThatAgree = 2;
  if (!models::is_info(models::sender_of(bytes))) return;
  if (early_info_.size() == kThatAgree) early_info_.pop_front();
  early_info_.push_back({received, {bytes.begin(), bytes.end()}});
}

void LidarNode::refuse(const char* counter, const std::string& remedy) {
  counters_.add(counter);
  health_.packet_refused(remedy);
  share_.refused(now_, counter);
}

Refusal LidarNode::on_info(std::int64_t received, std::span<const std::uint8_t> bytes) {
  if (const Refusal refusal = model_->read_info(received, bytes); refusal != Refusal::kNone) return refusal;
  counters_.add("difop");
  health_.info_packet_used();
  if (const models::Identity& identity = model_->facts().identity; identity != identity_) {
    identity_ = identity;
    print(fmt::format("{}: {}", model_->table().title, to_text(identity)));
  }
  return Refusal::kNone;
}

Refusal LidarNode::on_points(std::int64_t received, std::span<const std::uint8_t> bytes) {
  decoding::DecodedPacket& points = order_.spare();
  if (const Refusal refusal = model_->decode(received, bytes, points); refusal != Refusal::kNone) return refusal;
  if (!points.stamp) counters_.add("clock.invalid");
  if (points.stamp) *points.stamp += microseconds(config_.time_offset);
  const Refusal refusal = order_.take(received);
  if (refusal != Refusal::kNone) return refusal;
  for (int i = order_.discarded(); i > 0; --i)
    refuse(decoding::counter_of(Refusal::kStamp), remedy(Refusal::kStamp, model_->table()));
  if (order_.restarted()) clock_.restart();
  if (!host_is_synchronised_) host_is_synchronised_ = host_clock_();
  decoding::PendingPacket& packet = order_.taken();
  const decoding::PacketClock::Time time = clock_.time_of(
      packet.points.stamp, received, microseconds(packet.points.duration), *host_is_synchronised_, order_.in_order());
  packet.utime = time.utime;
  packet.host_utime = time.host_utime;
  return Refusal::kNone;
}

void LidarNode::send_ready() {
  while (decoding::PendingPacket* packet = order_.next()) send(*packet);
}

void LidarNode::send(decoding::PendingPacket& packet) {
  decoding::DecodedPacket& points = packet.points;
  const double blind = (360.0 - model_->facts().field_of_view) * 100.0;
  const decoding::HeadTracker::Step step =
      head_.follow({packet.host_utime, points.azimuth, points.rate, points.duration}, blind);
  if (step.duplicate || step.late) {
    const Refusal refusal = step.duplicate ? Refusal::kDuplicate : Refusal::kLate;
    if (step.late) lost_.subtract_late();
    refuse(decoding::counter_of(refusal), remedy(refusal, model_->table()));
    return;
  }
  lost_.add(packet.received, step.lost - packet.refused_before);
  not_sent_.add(packet.received, health_.is_silent() ? step.lost - packet.refused_before : 0);
  message_.revolution = config_.split_packets == 0 ? step.revolution : scan_of_count();
  message_.utime = packet.utime;
  message_.packet = message_.packet < 0 ? 0 : next_sequence_number(message_.packet);
  message_.num_points = static_cast<std::int32_t>(points.x.size());
  // The vectors are swapped between packet and message, so they are allocated only once.
  message_.x.swap(points.x);
  message_.y.swap(points.y);
  message_.z.swap(points.z);
  message_.time_offset.swap(points.time_offset);
  message_.intensity.swap(points.intensity);
  message_.ring.swap(points.ring);
  bus_.publish(config_.channel, message_);
  sent_.add({message_.utime, message_.packet, message_.revolution, points.fired});
  lasers_.add(message_.utime, message_.ring);

  counters_.add("packets");
  counters_.add("points", message_.num_points);
  if (points.out_of_range > 0) counters_.add("out_of_range", points.out_of_range);
  if (points.no_return > 0) counters_.add("no_return", points.no_return);
  latency_.add(static_cast<double>(packet.received - packet.utime) * 1e-6);
  health_.point_packet_used();
}

/// Counts in a variable of its own, because `packet` wraps at 2^31.
std::int32_t LidarNode::scan_of_count() {
  if (message_.packet < 0) return 0;
  if (++in_scan_ < config_.split_packets) return message_.revolution;
  in_scan_ = 0;
  return next_sequence_number(message_.revolution);
}

void LidarNode::publish_raw(std::int64_t received, int port, std::span<const std::uint8_t> bytes) {
  if (bytes.size() > kMaxRawSize) return counters_.add("dropped.raw_too_long");
  raw_packet_t raw;
  raw.utime = received;
  raw.port = port;
  raw.size = static_cast<std::int32_t>(bytes.size());
  raw.data.assign(bytes.begin(), bytes.end());
  bus_.publish(config_.raw_channel, raw);
}

void LidarNode::set_receive_buffer(int asked, int granted) {
  buffer_fault_.clear();
  if (granted < asked)
    buffer_fault_ = fmt::format(
        "the kernel grants the sockets {} kB of the {} kB of receive_buffer, and drops packets while this process has "
        "to wait: sysctl -w net.core.rmem_max={}, and net.core.rmem_max={} in a file of /etc/sysctl.d",
        granted / 1024, asked / 1024, asked, asked);
}

/// A step forward looks like a delay, which the clock's window would accept for seconds, and like lost packets.
void LidarNode::clock_was_set(std::int64_t by) {
  if (by <= 0) return;  // packets with earlier times of receipt show it
  counters_.add("clock.host_set");
  clock_.forget_offset();
  head_.clock_was_set(by);
}

void LidarNode::tick(std::int64_t now) {
  now_ = now;
  sent_.tick();
  health_.tick(now);
  share_.tick(now);
  // Held packets wait for their successors. If none arrives any more, they are released.
  if (!std::exchange(came_since_tick_, false) && order_.has_held()) {
    order_.flush();
    send_ready();
  }
  if (now - second_began_ < kSecond && now >= second_began_) return;
  second_began_ = now;
  host_is_synchronised_ = host_clock_();
  const std::int64_t lost_on_the_way = lost_.total() - not_sent_.total();
  lost_in_second_ = lost_on_the_way - std::exchange(lost_on_the_way_, lost_on_the_way);
}

void LidarNode::finish() {
  order_.flush();
  send_ready();
  lost_.settle_all();
}

NodeReport LidarNode::report() const {
  NodeReport report;
  add_counters(report.counters);
  for (const std::string* fault : {&source_fault_, &sender_fault_, &buffer_fault_}) {
    if (!fault->empty()) report.faults.push_back(*fault);
  }
  for (std::string& fault : health_.faults(model_.get())) report.faults.push_back(std::move(fault));
  if (share_.fault()) report.faults.push_back(*share_.fault());
  add_loss_faults(report.faults);
  add_clock_faults(report.faults);
  if (has_recent_info()) {
    for (const std::string& fault : model_->facts().faults) report.faults.push_back(fault);
  } else if (!model_ && report.counters["undecided"] > 0) {
    report.faults.push_back(
        fmt::format("model: auto: not decided yet; the last packets are from {}", models::title_of(vote_.leading())));
  }
  report.latency_p50 = latency_.percentile(0.5);
  report.latency_p99 = latency_.percentile(0.99);
  return report;
}

void LidarNode::add_counters(Counters& counters) const {
  counters.add(counters_);
  counters.set("revolutions", message_.packet < 0 ? 0 : message_.revolution + 1);
  counters.set("lost.packets", lost_.total());
  if (sent_.resent() > 0) counters.set("resent.packets", sent_.resent());
  set_level(counters, "clock.device", clock_.uses_device() ? 1 : 0);
  counters.set("clock.switches", clock_.switches());
  counters.set("clock.jumps", order_.jumps());
  if (const auto difference = clock_.difference()) set_level(counters, "clock.difference_us", *difference);
  set_level(counters, "clock.drift_ppm", std::llround(clock_.drift().drift() * 1e6));
  if (host_is_synchronised_) set_level(counters, "clock.host_synchronised", *host_is_synchronised_ ? 1 : 0);
  if (has_recent_info()) counters.set(model_->facts().values);
}

/// Faults of packets that were lost, and of lasers that return nothing.
void LidarNode::add_loss_faults(std::vector<std::string>& faults) const {
  if (lost_in_second_ > config_.most_lost)
    faults.push_back(
        fmt::format("{} packets were lost in a second: dropped.socket says how many of them this host lost, the rest "
                    "the network",
                    lost_in_second_));
  if (const std::vector<int> silent = lasers_.silent(); !silent.empty())
    faults.push_back(
        fmt::format("nothing comes back from laser {} any more (0: the lowest), although it does from those above and "
                    "below: clean the window, else have it repaired",
                    fmt::join(silent, ", ")));
}

void LidarNode::add_clock_faults(std::vector<std::string>& faults) const {
  if (auto fault = clock_.drift().fault()) faults.push_back(std::move(*fault));
  const auto difference = clock_.difference();
  if (!difference || config_.clock == decoding::ClockMode::kHost) return;
  const double seconds = static_cast<double>(*difference) * 1e-6;
  const double apart = std::abs(seconds);
  if (apart >= kTaiMinusUtcFrom && apart <= kTaiMinusUtcTo) {
    faults.push_back(
        fmt::format("the device's clock is {:.3f} s {} the host's, as TAI is from UTC: correct its time source, or set "
                    "time_offset: {}",
                    apart, seconds < 0 ? "behind" : "ahead of", seconds < 0 ? 37 : -37));
  } else if (config_.clock == decoding::ClockMode::kDevice && apart > config_.clock_tolerance) {
    faults.push_back("the device's clock is not set: use clock: auto or host, or connect its GPS");
  } else if (config_.clock == decoding::ClockMode::kAuto && apart > config_.clock_tolerance &&
             std::abs(*difference) < kNearlySet) {
    faults.push_back(
        fmt::format("the device's clock is {:.3f} s {} the host's, whose time is used: which one is wrong?", apart,
                    seconds < 0 ? "behind" : "ahead of"));
  }
}

}  // namespace curbstone::lidar
