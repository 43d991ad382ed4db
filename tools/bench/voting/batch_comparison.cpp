#include "tools/bench/voting/batch_comparison.hpp"

#include "services/tensor_voting/voting/batch_voting.hpp"
#include "tools/bench/voting/inputs/street_cloud.hpp"
#include "tools/bench/voting/pair_count.hpp"
#include "tools/bench/voting/pcl_normals.hpp"

namespace curbstone::bench::voting {

void measure_batch(BatchRow& row, bool with_pcl, const std::string& kernel, const timing::TurnOptions& options) {
  const auto cloud = inputs::street_cloud(row.points, row.length);
  const tensor_voting::voting::VotingParameters parameters{.sigma = row.sigma, .radius = row.radius, .voxel = 0};
  row.pair_votes = count_pair_votes(cloud, row.radius, row.threads);
  std::vector<timing::Contender> contenders;
  tensor_voting::voting::BatchVoter voter;
  tensor_voting::voting::CloudVotes votes;
  contenders.push_back({"ours", [&] { voter.vote(cloud, parameters, row.threads, {.kernel = kernel}, votes); }});
  const PclNormals pcl(cloud, row.radius, row.threads);
  if (with_pcl) contenders.push_back({"pcl", [&] { (void)pcl.run(); }});
  const std::vector<timing::TurnTimes> times = time_in_turn(contenders, options);
  row.ours = times[0];
  if (with_pcl) row.pcl = times[1];
}

double stick_sum() {
  const tensor_voting::voting::VotingParameters parameters{.sigma = 0.3, .radius = 0.9, .voxel = 0};
  double sum = 0;
  for (const tensor_voting::kernels::DecompositionF& d :
       tensor_voting::voting::vote_cloud(inputs::street_cloud(10'000), parameters).decompositions) {
    const double trace = (3 - parameters.ball) * double{d.mass};
    const double trace_in_l1 = double{d.stick} + 2 * double{d.plate} + 3 * double{d.ball};
    if (trace_in_l1 > 0) sum += double{d.stick} * trace / trace_in_l1;
  }
  return sum;
}

}  // namespace curbstone::bench::voting
