#include "tools/replay/stage_line.hpp"

#include <algorithm>
#include <utility>

namespace curbstone::replay {

namespace {

constexpr std::size_t kAtOnce = 64;  // messages; waking the next thread for each one costs more than the work on it

/// Thrown in the other threads when one has failed.
struct LineStopped {};

}  // namespace

StageLine::StageLine(std::vector<std::unique_ptr<StageGroup>> groups, Options options) : options_(std::move(options)) {
  for (auto& group : groups) {
    places_.push_back(std::make_unique<Place>());
    places_.back()->group = std::move(group);
  }
  for (std::size_t at = 0; at < places_.size(); ++at)
    places_[at]->group->when_published([this, at](LineItem message) { said(at, std::move(message)); });
  if (!options_.threads) return;
  for (std::size_t at = 0; at < places_.size(); ++at) places_[at]->thread = std::thread([this, at] { run(at); });
}

StageLine::~StageLine() {
  stop();
}

void StageLine::deliver(std::string channel, std::vector<std::uint8_t> bytes) {
  enter({LineItem::Kind::kMessage, std::move(channel), std::move(bytes)});
}

void StageLine::beat(std::int64_t now, bool ticks) {
  const std::int64_t number = beats_++;
  enter({LineItem::Kind::kBeat, {}, {}, number, now, ticks});
  if (!options_.threads) return;
  std::unique_lock lock(mutex_);
  moved_.wait(lock, [&] { return places_.front()->done >= number - kLag || failed_; });
}

void StageLine::end_drive() {
  enter({LineItem::Kind::kEndOfDrive, {}, {}});
}

void StageLine::wait() {
  {
    std::unique_lock lock(mutex_);
    const auto is_done = [&](const auto& place) { return place->done >= beats_ - 1; };
    moved_.wait(lock, [&] { return std::all_of(places_.begin(), places_.end(), is_done) || failed_; });
  }
  rethrow();
}

void StageLine::finish() {
  enter({LineItem::Kind::kEnd, {}, {}, beats_});
  for (const auto& place : places_) {
    if (place->thread.joinable()) place->thread.join();
  }
  rethrow();
}

Counters StageLine::bus_counters() const {
  Counters counters;
  for (const auto& place : places_) {
    counters.add(place->group->bus().counters());
  }
  return counters;
}

void StageLine::enter(LineItem item) {
  rethrow();
  if (!options_.threads) return work(0, std::move(item));
  const bool is_message = item.kind == LineItem::Kind::kMessage;
  entering_.push_back(std::move(item));
  if (!is_message || entering_.size() >= kAtOnce) places_.front()->in.push(std::exchange(entering_, {}));
}

void StageLine::run(std::size_t at) {
  try {
    while (true) {
      std::vector<LineItem> items = places_[at]->in.take();
      if (items.empty()) return;
      for (LineItem& item : items) {
        const bool is_end = item.kind == LineItem::Kind::kEnd;
        work(at, std::move(item));
        if (is_end) return;
      }
    }
  } catch (const LineStopped&) {
  } catch (...) {
    fail(std::current_exception());
  }
}

void StageLine::work(std::size_t at, LineItem item) {
  Place& place = *places_[at];
  switch (item.kind) {
    case LineItem::Kind::kMessage:
      if (place.group->hears(item.channel)) {
        // A message to this group may also be passed on, before the messages that result from it.
        if (is_wanted_after(at, item.channel)) place.out.push_back(item);
        place.group->deliver(item);
      } else {
        place.out.push_back(std::move(item));
      }
      if (place.out.size() >= kAtOnce || !options_.threads) flush(at);
      return;
    case LineItem::Kind::kBeat:
      for (const LineItem& message : back_until(at, item.number - kLag)) place.group->deliver(message);
      place.group->beat(item);
      break;
    case LineItem::Kind::kEndOfDrive:
      place.group->end_drive();
      place.out.push_back(std::move(item));
      return flush(at);
    case LineItem::Kind::kEnd:
      for (const LineItem& message : back_until(at, item.number - 1)) place.group->deliver(message);
      place.group->finish();
      break;
  }
  const std::int64_t number = item.number;
  place.out.push_back(std::move(item));
  flush(at);
  note_done(at, number);
}

void StageLine::said(std::size_t at, LineItem message) {
  Place& place = *places_[at];
  for (std::size_t to = 0; to < at; ++to) {
    if (!places_[to]->group->hears(message.channel)) continue;
    const std::lock_guard lock(mutex_);
    place.back[place.done + 1].emplace_back(to, message);
  }
  if (is_wanted_after(at, message.channel)) place.out.push_back(std::move(message));
}

bool StageLine::is_wanted_after(std::size_t at, const std::string& channel) const {
  if (options_.everything) return true;
  return std::any_of(places_.begin() + static_cast<std::ptrdiff_t>(at) + 1, places_.end(),
                     [&](const auto& place) { return place->group->hears(channel); });
}

std::vector<LineItem> StageLine::back_until(std::size_t at, std::int64_t beat) {
  std::vector<LineItem> messages;
  std::unique_lock lock(mutex_);
  for (std::size_t from = at + 1; from < places_.size(); ++from) {
    Place& place = *places_[from];
    moved_.wait(lock, [&] { return place.done >= beat || failed_; });
    if (failed_) throw LineStopped{};
    for (auto& [said_in, said] : place.back) {
      if (said_in > beat) break;
      for (auto& [to, message] : said) {
        if (to == at) messages.push_back(std::move(message));
      }
      std::erase_if(said, [&](const auto& to_message) { return to_message.first == at; });
    }
    while (!place.back.empty() && place.back.begin()->second.empty()) place.back.erase(place.back.begin());
  }
  return messages;
}

void StageLine::note_done(std::size_t at, std::int64_t beat) {
  {
    const std::lock_guard lock(mutex_);
    places_[at]->done = beat;
  }
  moved_.notify_all();
}

/// Passes the items to the next group; the last group's go to `everything`.
void StageLine::flush(std::size_t at) {
  std::vector<LineItem> items = std::exchange(places_[at]->out, {});
  if (at + 1 == places_.size()) {
    for (LineItem& item : items) {
      if (item.kind == LineItem::Kind::kBeat) last_now_ = item.now;
      if (!options_.everything || item.kind != LineItem::Kind::kMessage) continue;
      item.now = last_now_;
      options_.everything(std::move(item));
    }
  } else if (options_.threads) {
    if (!items.empty()) places_[at + 1]->in.push(std::move(items));
  } else {
    for (LineItem& item : items) work(at + 1, std::move(item));
  }
}

void StageLine::stop() {
  fail(nullptr);
  for (const auto& place : places_) {
    if (place->thread.joinable()) place->thread.join();
  }
}

/// A null error only stops the threads.
void StageLine::fail(std::exception_ptr error) {
  {
    const std::lock_guard lock(mutex_);
    if (!failed_) failed_ = error ? error : std::make_exception_ptr(LineStopped{});
  }
  for (const auto& place : places_) place->in.close();
  moved_.notify_all();
}

void StageLine::rethrow() {
  std::exception_ptr error;
  {
    const std::lock_guard lock(mutex_);
    error = failed_;
  }
  if (!error) return;
  stop();
  std::rethrow_exception(error);
}

}  // namespace curbstone::replay
