#include "common/service.hpp"
#include "services/tensor_voting/tensor_voting_node.hpp"

int main(int argc, char** argv) {
  using namespace curbstone;
  return run_service<TensorVotingConfig>(
      argc, argv, "tensor_voting", "Votes on the points of the map: normals, tangents, saliency shares",
      [](const TensorVotingConfig& config, ServiceContext& context) -> std::unique_ptr<Node> {
        return std::make_unique<TensorVotingNode>(config, context.name, context.bus);
      });
}
