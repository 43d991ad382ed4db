#pragma once

#include "services/mapper/mapper.hpp"
#include "tools/bench/mapping/mapping_method.hpp"

namespace curbstone {

/// Our mapper with one of its methods.
class MapperMethod final : public MappingMethod {
 public:
  explicit MapperMethod(const MapperConfig& config) : mapper_(config) {}

  [[nodiscard]] std::optional<StampedPose> process(const Revolution& revolution,
                                                   const OdometryHistory& odometry) override;
  [[nodiscard]] std::optional<Matrix6> covariance() const override { return covariance_; }
  void finish() override { (void)mapper_.finish(); }
  [[nodiscard]] MapContent content() const override;
  [[nodiscard]] int rearranged() const override { return rearranged_; }
  [[nodiscard]] Trajectory trajectory() const override;

 private:
  Mapper mapper_;
  std::optional<Matrix6> covariance_;
  int rearranged_ = 0;
};

}  // namespace curbstone
