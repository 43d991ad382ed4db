#include "services/viewer/store/curb_lines.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace curbstone::viewer::store {
namespace {

bool is_sound(const curb_line_t& line) {
  const auto n = static_cast<std::size_t>(std::max(0, line.num_points));
  for (const auto* list : {&line.x, &line.y, &line.z, &line.height, &line.high_side_x, &line.high_side_y}) {
    if (list->size() != n) return false;
    if (!std::all_of(list->begin(), list->end(), [](float v) { return std::isfinite(v) && std::abs(v) < 1e7F; }))
      return false;
  }
  return std::isfinite(line.confidence);
}

bool is_same(const curb_line_t& a, const curb_line_t& b) {
  return a.confidence == b.confidence && a.dropped == b.dropped && a.inferred == b.inferred && a.rise == b.rise &&
         a.x == b.x && a.y == b.y && a.z == b.z && a.height == b.height && a.high_side_x == b.high_side_x &&
         a.high_side_y == b.high_side_y;
}

bool is_inside(const curb_lines_t& box, float x, float y) {
  return x >= box.box_min[0] && x <= box.box_max[0] && y >= box.box_min[1] && y <= box.box_max[1];
}

/// Points [first, last) of a line.
curb_line_t piece_of(const curb_line_t& line, std::size_t first, std::size_t last) {
  const auto cut = [=](const std::vector<float>& list) {
    return std::vector<float>(list.begin() + static_cast<std::ptrdiff_t>(first),
                              list.begin() + static_cast<std::ptrdiff_t>(last));
  };
  curb_line_t piece;
  piece.id = line.id;
  piece.confidence = line.confidence;
  piece.dropped = line.dropped;
  piece.inferred = line.inferred;
  piece.rise = line.rise;
  piece.num_points = static_cast<std::int32_t>(last - first);
  piece.x = cut(line.x);
  piece.y = cut(line.y);
  piece.z = cut(line.z);
  piece.height = cut(line.height);
  piece.high_side_x = cut(line.high_side_x);
  piece.high_side_y = cut(line.high_side_y);
  return piece;
}

/// The parts of a line that lie outside of the box, and those with one vertex inside at their ends, so that they touch
/// what the box holds.
std::vector<curb_line_t> pieces_outside(const curb_line_t& line, const curb_lines_t& box) {
  std::vector<curb_line_t> pieces;
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

}  // namespace

CurbLines::Put CurbLines::put(const curb_lines_t& message) {
  const bool has_box = message.box_min[0] <= message.box_max[0] && message.box_min[1] <= message.box_max[1];
  if (!has_box || !std::all_of(message.lines.begin(), message.lines.end(), is_sound)) return Put::kRefused;
  std::vector<curb_line_t> news = message.lines;
  make_room(message, news);
  Put result = Put::kTaken;
  for (curb_line_t& line : news) {
    if (vertices_ + line.x.size() <= kMaxVertices)
      add(std::move(line));
    else
      result = Put::kFull;
  }
  return result;
}

void CurbLines::make_room(const curb_lines_t& message, std::vector<curb_line_t>& news) {
  std::vector<curb_line_t> left;
  for (auto it = lines_.begin(); it != lines_.end();) {
    const curb_line_t& line = it->second;
    const auto again = std::find_if(news.begin(), news.end(), [&](const curb_line_t& n) { return is_same(n, line); });
    const auto inside = [&](std::size_t i) { return is_inside(message, line.x[i], line.y[i]); };
    bool touches = false;
    for (std::size_t i = 0; i < line.x.size() && !touches; ++i) touches = inside(i);
    if (again != news.end()) {
      news.erase(again);
      ++it;
      continue;
    }
    if (!touches) {
      ++it;
      continue;
    }
    std::vector<curb_line_t> pieces = pieces_outside(line, message);
    if (pieces.size() == 1 && pieces.front().x.size() == line.x.size()) {  // cut there before
      ++it;
      continue;
    }
    std::move(pieces.begin(), pieces.end(), std::back_inserter(left));
    it = remove(it);
  }
  for (curb_line_t& piece : left) add(std::move(piece));
}

CurbLines::Lines::iterator CurbLines::remove(Lines::iterator line) {
  vertices_ -= line->second.x.size();
  gone_.push_back({++number_, line->first});
  if (gone_.size() > kMaxGone) {
    forgotten_ = gone_.front().number;
    gone_.pop_front();
  }
  return lines_.erase(line);
}

void CurbLines::add(curb_line_t line) {
  if (line.x.size() < 2) return;
  vertices_ += line.x.size();
  lines_.emplace(++number_, std::move(line));
}

void CurbLines::clear() {
  lines_.clear();
  gone_.clear();
  vertices_ = 0;
  forgotten_ = ++number_;
}

CurbLines::News CurbLines::above(std::uint32_t number) const {
  News news;
  news.number = number_;
  news.everything = number < forgotten_ || number == 0 || number > number_;
  const std::uint32_t from = news.everything ? 0 : number;
  for (auto it = lines_.upper_bound(from); it != lines_.end(); ++it) news.added.push_back({it->first, &it->second});
  if (news.everything) return news;
  // Names of lines that came after `number` mean nothing to the listener.
  for (const Gone& gone : gone_) {
    if (gone.number > number && gone.name <= number) news.gone.push_back(gone.name);
  }
  return news;
}

}  // namespace curbstone::viewer::store
