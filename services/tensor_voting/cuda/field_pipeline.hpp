#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "services/tensor_voting/cuda/batch_steps.hpp"
#include "services/tensor_voting/cuda/resident_voters.hpp"

namespace curbstone::tensor_voting::cuda {

/// Merges two sorted lists of voters: each voter finds its own place. Of equal keys the resident ones come first.
struct MergeInto {
  const std::uint64_t* keys;
  const ResidentVoter* voters;
  const ResidentSums* sums;
  const std::uint64_t* other_keys;
  std::uint32_t num_others;
  bool after_equals;
  std::uint64_t* to_keys;
  ResidentVoter* to_voters;
  ResidentSums* to_sums;

  CURBSTONE_HD void operator()(std::uint32_t i) const {
    const std::uint32_t place = i + lower_bound(other_keys, 0, num_others, keys[i] + (after_equals ? 1 : 0));
    to_keys[place] = keys[i];
    to_voters[place] = voters[i];
    to_sums[place] = sums[i];
  }
};

/// Permutes voters into sorted order.
struct PermuteVoters {
  const std::uint32_t* order;
  const ResidentVoter* voters;
  ResidentVoter* to;

  CURBSTONE_HD void operator()(std::uint32_t i) const { to[i] = voters[order[i]]; }
};

/// Gives voters of removed tiles a key behind all other keys.
struct MarkRemoved {
  const std::uint64_t* keys;
  const ResidentVoter* voters;
  const std::uint8_t* tiles;
  std::uint64_t* marked;
  std::uint32_t* order;

  CURBSTONE_HD void operator()(std::uint32_t i) const {
    marked[i] = tiles[voters[i].tile] != 0 ? CellGrid::kNoCell : keys[i];
    order[i] = i;
  }
};

struct PermuteResidents {
  const std::uint32_t* order;
  const std::uint64_t* keys;
  const ResidentVoter* voters;
  const ResidentSums* sums;
  std::uint64_t* to_keys;
  ResidentVoter* to_voters;
  ResidentSums* to_sums;

  CURBSTONE_HD void operator()(std::uint32_t i) const {
    to_keys[i] = keys[order[i]];
    to_voters[i] = voters[order[i]];
    to_sums[i] = sums[order[i]];
  }
};

struct CollectSums {
  const ResidentVoter* voters;
  const ResidentSums* sums;
  const std::uint32_t* offsets;  ///< by slot
  ResidentSums* to;

  CURBSTONE_HD void operator()(std::uint32_t i) const {
    const std::uint32_t offset = offsets[voters[i].tile];
    if (offset != ResidentVoters::kUnwanted) to[offset + voters[i].number] = sums[i];
  }
};

/// ResidentVoters on a machine (BatchPipeline defines what a machine is).
template <class Machine>
class ResidentVotersOn : public ResidentVoters {
 public:
  ResidentVotersOn(Machine machine, const CellGrid& grid, const kernels::Decay& decay)
      : machine_(std::move(machine)), grid_(grid), decay_(decay) {}

  std::vector<std::uint8_t> add(const std::vector<std::uint64_t>& keys, const std::vector<ResidentVoter>& voters,
                                std::uint32_t num_slots) override {
    const auto n = static_cast<std::uint32_t>(keys.size());
    Part fresh = upload(keys, voters);
    Part merged = allocate(all_.size + n);
    Flags changed = zeros(num_slots);
    gather(all_, fresh, 1, changed);  // old voters gather from the new ones only
    gather(fresh, all_, 1, changed);
    gather(fresh, fresh, 1, changed);
    merge(all_, fresh, false, merged);
    merge(fresh, all_, true, merged);
    std::vector<std::uint8_t> flags = download(changed, num_slots);
    all_ = std::move(merged);
    return flags;
  }

  std::vector<std::uint8_t> remove(const std::vector<std::uint8_t>& tiles, std::uint32_t count) override {
    const auto num_slots = static_cast<std::uint32_t>(tiles.size());
    auto removed = machine_.upload(tiles.data(), num_slots);
    auto marked = machine_.template allocate<std::uint64_t>(all_.size);
    auto order = machine_.template allocate<std::uint32_t>(all_.size);
    Part sorted = allocate(all_.size);
    Flags changed = zeros(num_slots);
    machine_.for_each(all_.size,
                      MarkRemoved{all_.keys.data(), all_.voters.data(), removed.data(), marked.data(), order.data()});
    machine_.sort(marked, order, all_.size);
    machine_.for_each(all_.size, PermuteResidents{order.data(), all_.keys.data(), all_.voters.data(), all_.sums.data(),
                                                  sorted.keys.data(), sorted.voters.data(), sorted.sums.data()});
    const std::uint32_t left = all_.size - count;
    gather(sorted.keys.data(), left, sorted, sorted.keys.data() + left, count, sorted.voters.data() + left, -1,
           changed);
    std::vector<std::uint8_t> flags = download(changed, num_slots);
    sorted.size = left;
    all_ = std::move(sorted);
    return flags;
  }

  std::vector<ResidentSums> sums(const std::vector<std::uint32_t>& offsets, std::uint32_t total) override {
    auto by_slot = machine_.upload(offsets.data(), offsets.size());
    auto found = machine_.template allocate<ResidentSums>(total);
    machine_.for_each(all_.size, CollectSums{all_.voters.data(), all_.sums.data(), by_slot.data(), found.data()});
    std::vector<ResidentSums> result(total);
    machine_.download(found, total, result.data());
    return result;
  }

  void clear() override { all_ = {}; }

 private:
  template <class T>
  using Array = typename Machine::template Array<T>;
  using Flags = Array<std::uint8_t>;

  /// Voters in the order of their keys.
  struct Part {
    std::uint32_t size = 0;
    Array<std::uint64_t> keys;
    Array<ResidentVoter> voters;
    Array<ResidentSums> sums;
  };

  Part allocate(std::uint32_t size) {
    return {size, machine_.template allocate<std::uint64_t>(size), machine_.template allocate<ResidentVoter>(size),
            machine_.template allocate<ResidentSums>(size)};
  }
  Flags zeros(std::uint32_t num_slots) {
    Flags flags = machine_.template allocate<std::uint8_t>(num_slots);
    machine_.zero(flags, num_slots);
    return flags;
  }
  std::vector<std::uint8_t> download(const Flags& flags, std::uint32_t num_slots) {
    std::vector<std::uint8_t> result(num_slots);
    machine_.download(flags, num_slots, result.data());
    return result;
  }

  Part upload(const std::vector<std::uint64_t>& keys, const std::vector<ResidentVoter>& voters) {
    const auto n = static_cast<std::uint32_t>(keys.size());
    std::vector<std::uint32_t> numbers(n);
    for (std::uint32_t i = 0; i < n; ++i) numbers[i] = i;
    Part part = allocate(n);
    part.keys = machine_.upload(keys.data(), n);
    auto unsorted = machine_.upload(voters.data(), n);
    auto order = machine_.upload(numbers.data(), n);
    machine_.sort(part.keys, order, n);
    machine_.for_each(n, PermuteVoters{order.data(), unsorted.data(), part.voters.data()});
    machine_.zero(part.sums, n);
    return part;
  }

  void gather(Part& votees, const Part& voters, float sign, Flags& changed) {
    gather(votees.keys.data(), votees.size, votees, voters.keys.data(), voters.size, voters.voters.data(), sign,
           changed);
  }
  void gather(const std::uint64_t* keys, std::uint32_t size, Part& votees, const std::uint64_t* voter_keys,
              std::uint32_t num_voters, const ResidentVoter* voters, float sign, Flags& changed) {
    if (size == 0 || num_voters == 0) return;
    ExactVotes votes;
    votes.decay = decay_;
    votes.sign = sign;
    votes.votees = votees.voters.data();
    votes.voters = voters;
    votes.received = votees.sums.data();
    votes.changed = changed.data();
    machine_.for_each_window(kParts * num_windows(size),
                             GatherWindow<ExactVotes>{grid_, {keys, size}, {voter_keys, num_voters}, votes});
  }

  void merge(const Part& from, const Part& other, bool after_equals, Part& to) {
    machine_.for_each(from.size, MergeInto{from.keys.data(), from.voters.data(), from.sums.data(), other.keys.data(),
                                           other.size, after_equals, to.keys.data(), to.voters.data(), to.sums.data()});
  }

  Machine machine_;
  CellGrid grid_;
  kernels::Decay decay_;
  Part all_;
};

}  // namespace curbstone::tensor_voting::cuda
