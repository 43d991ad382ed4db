#include <cstdio>
#include <vector>

#include "services/tensor_voting/batch_voting.hpp"
#include "services/tensor_voting/decomposition.hpp"

int main() {
  std::vector<Eigen::Vector3d> floor;
  for (int i = 0; i < 400; ++i) floor.emplace_back(0.1 * (i % 20), 0.1 * (i / 20), 0);
  const curbstone::CloudVotes votes = curbstone::vote_cloud(floor, {});
  const curbstone::Decomposition d = curbstone::decompose(votes.tensors[210]);
  std::printf("normal %.3f %.3f %.3f stick %.3f\n", d.normal.x(), d.normal.y(), d.normal.z(), d.stick);
  return d.normal.z() > 0.999 ? 0 : 1;
}
