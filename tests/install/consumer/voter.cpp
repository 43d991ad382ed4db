#include <cstdio>
#include <vector>

#include "services/tensor_voting/kernels/decomposition.hpp"
#include "services/tensor_voting/voting/batch_voting.hpp"

int main() {
  std::vector<Eigen::Vector3d> floor;
  for (int i = 0; i < 400; ++i) floor.emplace_back(0.1 * (i % 20), 0.1 * (i / 20), 0);
  const curbstone::tensor_voting::voting::CloudVotes votes = curbstone::tensor_voting::voting::vote_cloud(floor, {});
  const curbstone::tensor_voting::kernels::DecompositionF& d = votes.decompositions[210];
  std::printf("normal %.3f %.3f %.3f stick %.3f\n", double{d.normal.x()}, double{d.normal.y()}, double{d.normal.z()},
              double{d.stick});
  return d.normal.z() > 0.999F ? 0 : 1;
}
