#include <stdexcept>

#include "services/tensor_voting/cuda/cuda_backend.hpp"

namespace curbstone::tensor_voting::cuda {

std::string why_no_device() {
  return "built without CUDA: no nvcc was found, or CURBSTONE_CUDA is off";
}

std::unique_ptr<CloudBatch> make_cloud_batch() {
  throw std::runtime_error(why_no_device());
}

TimedBatch time_on_device(const double*, std::uint32_t, const BatchRequest&, int) {
  throw std::runtime_error(why_no_device());
}

std::unique_ptr<ResidentVoters> make_resident_voters(const CellGrid&, const kernels::Decay&) {
  throw std::runtime_error(why_no_device());
}

}  // namespace curbstone::tensor_voting::cuda
