#pragma once

#include <cstddef>
#include <cstdint>
#include <curbstone/curb_lines_t.hpp>
#include <deque>
#include <map>
#include <vector>

namespace curbstone::viewer::store {

/// The curbs of the whole epoch, put together from CURBS, each of which speaks of the box around the vehicle. A message
/// replaces what lies within its box; lines that leave the box are cut there. A line never changes: it goes, and others
/// come. So a listener needs the lines above a number, and the names of those that went since. Bounded. Pure; one
/// thread.
class CurbLines {
 public:
  static constexpr std::size_t kMaxVertices = 500'000;  ///< 100 km of curb
  static constexpr std::size_t kMaxGone = 20'000;       ///< names kept of lines that went

  enum class Put {
    kTaken,
    kRefused,  ///< not finite, or lists of other lengths
    kFull,
  };
  Put put(const curb_lines_t& message);
  /// Numbers go on.
  void clear();

  /// What happened after a number.
  struct News {
    std::uint32_t number = 0;         ///< of the last event
    bool everything = false;          ///< what the listener has is void: `added` is all there is
    std::vector<std::uint32_t> gone;  ///< names
    struct Added {
      std::uint32_t name;
      const curb_line_t* line;  ///< valid until the next put() or clear()
    };
    std::vector<Added> added;
  };
  /// 0: from the beginning.
  [[nodiscard]] News above(std::uint32_t number) const;
  [[nodiscard]] std::uint32_t number() const { return number_; }

 private:
  using Lines = std::map<std::uint32_t, curb_line_t>;
  Lines::iterator remove(Lines::iterator line);
  void add(curb_line_t line);
  /// Takes out what lies in the message's box, but for lines that the message repeats, which go from `news`.
  void make_room(const curb_lines_t& message, std::vector<curb_line_t>& news);

  struct Gone {
    std::uint32_t number;
    std::uint32_t name;
  };
  std::uint32_t number_ = 0;
  std::uint32_t forgotten_ = 0;  // what went up to this number is not known any more
  Lines lines_;                  // by name, which is the number at which the line came
  std::deque<Gone> gone_;
  std::size_t vertices_ = 0;
};

}  // namespace curbstone::viewer::store
