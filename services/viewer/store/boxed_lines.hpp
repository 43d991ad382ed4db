#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <iterator>
#include <map>
#include <utility>
#include <vector>

namespace curbstone::viewer::store {

/// The lines of the whole epoch, merged from CURBS or MARKINGS messages, each of which covers the box around the
/// vehicle. A message replaces all lines within its box; lines that cross the edge of the box are cut there. A line is
/// never modified: it is removed, and new ones are added. So a listener needs the lines above its number, and the names
/// of the lines removed since. Bounded. Pure; one thread.
///
/// The namespace curbstone has to provide for the Line type of the message:
///   bool is_sound(const Line&): finite, lists of the same length
///   bool is_same(const Line&, const Line&): equal in all but the id
///   Line piece_of(const Line&, std::size_t first, std::size_t last): its points from `first` up to before `last`
template <class Message>
class BoxedLines {
 public:
  using Line = typename decltype(Message::lines)::value_type;
  static constexpr std::size_t kMaxVertices = 500'000;  ///< 100 km of curb
  static constexpr std::size_t kMaxGone = 20'000;       ///< names of removed lines that are kept

  enum class Put {
    kTaken,
    kRefused,  ///< not finite, or lists of different lengths
    kFull,
  };
  Put put(const Message& message);
  /// Removes all lines; the numbers continue.
  void clear();

  /// What changed after a number.
  struct Changes {
    std::uint32_t number = 0;         ///< of the last change
    bool everything = false;          ///< the listener discards all it has: `added` is complete
    std::vector<std::uint32_t> gone;  ///< names of removed lines
    struct Added {
      std::uint32_t name;
      const Line* line;  ///< valid until the next put() or clear()
    };
    std::vector<Added> added;
  };
  /// `number` 0: from the beginning.
  [[nodiscard]] Changes above(std::uint32_t number) const;
  [[nodiscard]] std::uint32_t number() const { return number_; }

 private:
  using Lines = std::map<std::uint32_t, Line>;
  typename Lines::iterator remove(typename Lines::iterator line);
  void add(Line line);
  /// Removes the lines within the message's box. Lines that the message repeats are kept, and erased from `added`
  /// instead.
  void make_room(const Message& message, std::vector<Line>& added);

  static bool is_inside(const Message& box, float x, float y) {
    return x >= box.box_min[0] && x <= box.box_max[0] && y >= box.box_min[1] && y <= box.box_max[1];
  }
  /// The parts of a line outside the box. Each part includes one vertex inside the box where the line enters it, so
  /// that it touches the lines within the box.
  static std::vector<Line> pieces_outside(const Line& line, const Message& box);

  struct Gone {
    std::uint32_t number;
    std::uint32_t name;
  };
  std::uint32_t number_ = 0;
  std::uint32_t forgotten_ = 0;  // removals up to this number are no longer kept
  Lines lines_;                  // by name, which is the number at which the line was added
  std::deque<Gone> gone_;
  std::size_t vertices_ = 0;
};

template <class Message>
typename BoxedLines<Message>::Put BoxedLines<Message>::put(const Message& message) {
  const bool has_box = message.box_min[0] <= message.box_max[0] && message.box_min[1] <= message.box_max[1];
  if (!has_box ||
      !std::all_of(message.lines.begin(), message.lines.end(), [](const Line& line) { return is_sound(line); }))
    return Put::kRefused;
  std::vector<Line> added = message.lines;
  make_room(message, added);
  Put result = Put::kTaken;
  for (Line& line : added) {
    if (vertices_ + line.x.size() <= kMaxVertices)
      add(std::move(line));
    else
      result = Put::kFull;
  }
  return result;
}

template <class Message>
void BoxedLines<Message>::make_room(const Message& message, std::vector<Line>& added) {
  std::vector<Line> left;
  for (auto it = lines_.begin(); it != lines_.end();) {
    const Line& line = it->second;
    const auto again = std::find_if(added.begin(), added.end(), [&](const Line& n) { return is_same(n, line); });
    const auto inside = [&](std::size_t i) { return is_inside(message, line.x[i], line.y[i]); };
    bool touches = false;
    for (std::size_t i = 0; i < line.x.size() && !touches; ++i) touches = inside(i);
    if (again != added.end()) {
      added.erase(again);
      ++it;
      continue;
    }
    if (!touches) {
      ++it;
      continue;
    }
    std::vector<Line> pieces = pieces_outside(line, message);
    if (pieces.size() == 1 && pieces.front().x.size() == line.x.size()) {  // only its ends are inside: already cut
      ++it;
      continue;
    }
    std::move(pieces.begin(), pieces.end(), std::back_inserter(left));
    it = remove(it);
  }
  for (Line& piece : left) add(std::move(piece));
}

template <class Message>
typename BoxedLines<Message>::Lines::iterator BoxedLines<Message>::remove(typename Lines::iterator line) {
  vertices_ -= line->second.x.size();
  gone_.push_back({++number_, line->first});
  if (gone_.size() > kMaxGone) {
    forgotten_ = gone_.front().number;
    gone_.pop_front();
  }
  return lines_.erase(line);
}

template <class Message>
void BoxedLines<Message>::add(Line line) {
  if (line.x.size() < 2) return;
  vertices_ += line.x.size();
  lines_.emplace(++number_, std::move(line));
}

template <class Message>
void BoxedLines<Message>::clear() {
  lines_.clear();
  gone_.clear();
  vertices_ = 0;
  forgotten_ = ++number_;
}

template <class Message>
typename BoxedLines<Message>::Changes BoxedLines<Message>::above(std::uint32_t number) const {
  Changes changes;
  changes.number = number_;
  changes.everything = number < forgotten_ || number == 0 || number > number_;
  const std::uint32_t from = changes.everything ? 0 : number;
  for (auto it = lines_.upper_bound(from); it != lines_.end(); ++it) changes.added.push_back({it->first, &it->second});
  if (changes.everything) return changes;
  // Lines added after `number` are unknown to the listener, so their names are left out.
  for (const Gone& gone : gone_) {
    if (gone.number > number && gone.name <= number) changes.gone.push_back(gone.name);
  }
  return changes;
}

template <class Message>
std::vector<typename BoxedLines<Message>::Line> BoxedLines<Message>::pieces_outside(const Line& line,
                                                                                    const Message& box) {
  std::vector<Line> pieces;
  const std::size_t n = line.x.size();
  for (std::size_t i = 0; i < n;) {
    if (is_inside(box, line.x[i], line.y[i])) {
      ++i;
      continue;
    }
    std::size_t end = i;
    while (end < n && !is_inside(box, line.x[end], line.y[end])) ++end;
    pieces.push_back(piece_of(line, i > 0 ? i - 1 : i, end < n ? end + 1 : end));
    i = end;
  }
  return pieces;
}

}  // namespace curbstone::viewer::store
