#include "tools/bench/voting/cuda_fields.hpp"

#include <algorithm>
#include <chrono>
#include <utility>

namespace curbstone::bench::voting {

CudaFields::CudaFields(std::vector<tensor_voting::cuda::CudaVotingField> fields) : fields_(std::move(fields)) {}

void CudaFields::add(TileKey key, std::int32_t z_origin, bool replaced, std::span<const TilePoint> points) {
  if (replaced) {
    std::erase_if(waiting_, [&](const Waiting& one) { return one.key == key; });
    if (std::find(replaced_.begin(), replaced_.end(), key) == replaced_.end()) replaced_.push_back(key);
  }
  waiting_.push_back({key, z_origin, {points.begin(), points.end()}});
}

void CudaFields::end_revolution(bool counts) {
  std::vector<tensor_voting::cuda::CudaVotingField::Addition> additions;
  for (const Waiting& one : waiting_) additions.push_back({one.key, one.z_origin, one.points});
  auto lap = [last = std::chrono::steady_clock::now()]() mutable {  // ms
    const auto now = std::chrono::steady_clock::now();
    return std::chrono::duration<double, std::milli>(now - std::exchange(last, now)).count();
  };
  double add_ms = 0;
  double votes_ms = 0;
  for (tensor_voting::cuda::CudaVotingField& field : fields_) {
    if (!replaced_.empty()) field.remove(replaced_);
    field.add(additions);
    add_ms += lap();
    const std::vector<TileKey> changed = field.take_changed();
    [[maybe_unused]] const auto votes = field.votes(changed);
    votes_ms += lap();
  }
  waiting_.clear();
  replaced_.clear();
  if (!counts) return;
  add_ms_.push_back(add_ms);
  votes_ms_.push_back(votes_ms);
}

CudaGrowth CudaFields::growth(std::span<const tensor_voting::voting::VotingField> fields,
                              std::span<const TileKey> keys) {
  end_revolution(false);  // points after the last revolution
  CudaGrowth growth{scan_times(add_ms_), scan_times(votes_ms_)};
  for (std::size_t i = 0; i < fields_.size(); ++i) {
    for (const TileKey& key : keys) {
      const auto expected = fields[i].sums(key);
      const auto found = fields_[i].votes(key).sums;
      growth.compared += expected.size();
      for (std::size_t v = 0; v < expected.size(); ++v)
        if (v >= found.size() || expected[v] != found[v]) ++growth.different;
    }
  }
  return growth;
}

}  // namespace curbstone::bench::voting
