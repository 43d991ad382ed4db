#pragma once

#include <optional>

#include "services/mapper/config/mapper_config.hpp"
#include "services/mapper/mapper.hpp"
#include "tools/bench/mapping/methods/mapping_method.hpp"

namespace curbstone::bench::mapping::methods {

/// Our mapper with one of its registration methods.
class MapperMethod final : public MappingMethod {
 public:
  explicit MapperMethod(const mapper::config::MapperConfig& config)
      : mapper_(config, mapper::make_spill_file(config)) {}

  [[nodiscard]] std::optional<evaluate::truth::StampedPose> process(
      const mapper::scan::Scan& scan, const mapper::scan::OdometryHistory& odometry) override;
  [[nodiscard]] std::optional<mapper::registration::Matrix6> covariance() const override { return covariance_; }
  void finish() override { (void)mapper_.finish(); }
  [[nodiscard]] MapContent content() const override;
  [[nodiscard]] int rearranged() const override { return rearranged_; }
  [[nodiscard]] evaluate::truth::Trajectory trajectory() const override;

 private:
  mapper::Mapper mapper_;
  std::optional<mapper::registration::Matrix6> covariance_;
  int rearranged_ = 0;
};

}  // namespace curbstone::bench::mapping::methods
