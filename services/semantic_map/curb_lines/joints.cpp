#include "services/semantic_map/curb_lines/joints.hpp"

#include <algorithm>
#include <tuple>

namespace curbstone::semantic_map::curb_lines {
namespace {

/// The free end of a line that begins with the free end `end`.
std::size_t far_end(std::size_t end, const std::vector<std::size_t>& partner) {
  end = opposite(end);
  while (partner[end] != kFree) end = opposite(partner[end]);
  return end;
}

}  // namespace

std::vector<std::size_t> join_shortest_first(std::size_t num_pieces, std::vector<Joint> joints) {
  std::sort(joints.begin(), joints.end(),
            [](const Joint& a, const Joint& b) { return std::tie(a.gap, a.a, a.b) < std::tie(b.gap, b.a, b.b); });
  std::vector<std::size_t> partner(2 * num_pieces, kFree);
  for (const Joint& joint : joints) {
    if (partner[joint.a] != kFree || partner[joint.b] != kFree || far_end(joint.a, partner) == joint.b) continue;
    partner[joint.a] = joint.b;
    partner[joint.b] = joint.a;
  }
  return partner;
}

}  // namespace curbstone::semantic_map::curb_lines
