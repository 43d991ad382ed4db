#include "tools/bench/mapping/methods/pcl_method.hpp"

#include <pcl/filters/voxel_grid.h>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>
#include <pcl/registration/gicp.h>
#include <pcl/registration/icp.h>
#include <pcl/registration/ndt.h>

#include <algorithm>
#include <set>

namespace curbstone::bench::mapping::methods {
namespace {

using Cloud = pcl::PointCloud<pcl::PointXYZ>;

constexpr float kSourceVoxel = 0.3F, kMapVoxel = 0.2F;  // m
constexpr float kMaxRange = 60.0F;                      // m
constexpr float kWindow = 60.0F;                        // m, size of the local map around the vehicle
constexpr double kInsertEvery = 1.0;                    // m
constexpr int kFirstInsertions = 3;                     // revolutions at the start that are always inserted

Cloud::Ptr thinned(const Cloud::Ptr& cloud, float leaf) {
  auto out = std::make_shared<Cloud>();
  pcl::VoxelGrid<pcl::PointXYZ> grid;
  grid.setLeafSize(leaf, leaf, leaf);
  grid.setInputCloud(cloud);
  grid.filter(*out);
  return out;
}

std::shared_ptr<pcl::Registration<pcl::PointXYZ, pcl::PointXYZ>> make_pcl(PclMethod::Kind kind) {
  if (kind == PclMethod::Kind::kNdt) {
    auto ndt = std::make_shared<pcl::NormalDistributionsTransform<pcl::PointXYZ, pcl::PointXYZ>>();
    ndt->setResolution(1.0F);
    ndt->setStepSize(0.1);
    ndt->setTransformationEpsilon(0.01);
    ndt->setMaximumIterations(30);
    return ndt;
  }
  std::shared_ptr<pcl::Registration<pcl::PointXYZ, pcl::PointXYZ>> icp;
  if (kind == PclMethod::Kind::kGicp) {
    icp = std::make_shared<pcl::GeneralizedIterativeClosestPoint<pcl::PointXYZ, pcl::PointXYZ>>();
  } else {
    icp = std::make_shared<pcl::IterativeClosestPoint<pcl::PointXYZ, pcl::PointXYZ>>();
  }
  icp->setMaxCorrespondenceDistance(1.0);
  icp->setMaximumIterations(50);
  icp->setTransformationEpsilon(1e-6);
  return icp;
}

}  // namespace

struct PclMethod::Parts {
  std::shared_ptr<pcl::Registration<pcl::PointXYZ, pcl::PointXYZ>> registration;
  Cloud::Ptr local = std::make_shared<Cloud>();
  int insertions = 0;
  std::set<std::array<int, 3>> all;       // voxels of 0.2 m that have held a point
  std::set<std::array<int, 2>> all_flat;  // cells of 0.12 m

  void insert(const Cloud::Ptr& cloud, const Pose& T_map_base) {
    const Eigen::Isometry3f T = T_map_base.cast<float>();
    const auto cell = [](float v, float size) { return static_cast<int>(std::floor(v / size)); };
    for (const pcl::PointXYZ& point : *cloud) {
      const Eigen::Vector3f p = T * point.getVector3fMap();
      local->emplace_back(p.x(), p.y(), p.z());
      all.insert({cell(p.x(), kMapVoxel), cell(p.y(), kMapVoxel), cell(p.z(), kMapVoxel)});
      all_flat.insert({cell(p.x(), 0.12F), cell(p.y(), 0.12F)});
    }
    local = thinned(local, kMapVoxel);
    const Eigen::Vector3f here = T.translation();
    std::erase_if(local->points, [&](const pcl::PointXYZ& p) { return (p.getVector3fMap() - here).norm() > kWindow; });
    local->width = static_cast<std::uint32_t>(local->size());
    local->height = 1;
    registration->setInputTarget(local);
    ++insertions;
  }
};

PclMethod::PclMethod(Kind kind, const VehicleConfig& vehicle)
    : parts_(std::make_unique<Parts>()), T_base_lidar_(vehicle.T_base_lidar()) {
  parts_->registration = make_pcl(kind);
}

PclMethod::~PclMethod() = default;

std::optional<evaluate::truth::StampedPose> PclMethod::process(const mapper::scan::Scan& scan,
                                                               const mapper::scan::OdometryHistory& odometry) {
  const std::int64_t from = last_ ? std::min(last_->utime, scan.start) : scan.start;
  const bool guided = odometry.covers(from, scan.end);
  const double sweep_seconds = 1e-6 * static_cast<double>(scan.end - scan.start);
  const mapper::scan::SweepMotion sweep = guided ? mapper::scan::sweep_from(odometry, scan.start, scan.end)
                                                 : mapper::scan::steady_sweep(twist_, sweep_seconds);
  auto cloud = std::make_shared<Cloud>();
  for (const mapper::scan::LidarPoint& p : mapper::scan::deskew(scan.points, T_base_lidar_, sweep)) {
    if (p.position.norm() < kMaxRange) cloud->emplace_back(p.position.x(), p.position.y(), p.position.z());
  }
  Pose T_map_base = Pose::Identity();
  if (last_) {
    const double stride = 1e-6 * static_cast<double>(scan.end - last_->utime);
    const Pose motion =
        guided ? odometry.at(last_->utime).inverse() * odometry.at(scan.end) : mapper::scan::move(twist_, stride);
    T_map_base = normalised(last_->pose * motion);
    Cloud aligned;
    parts_->registration->setInputSource(thinned(cloud, kSourceVoxel));
    parts_->registration->align(aligned, T_map_base.matrix().cast<float>());
    Pose found = Pose::Identity();
    found.matrix() = parts_->registration->getFinalTransformation().cast<double>();
    if (is_finite(found)) T_map_base = normalised(found);
    twist_ = mapper::scan::twist_of(last_->pose.inverse() * T_map_base, stride);
  }
  const double moved = (T_map_insertion_.inverse() * T_map_base).translation().norm();
  if (parts_->insertions < kFirstInsertions || moved > kInsertEvery) {
    parts_->insert(cloud, T_map_base);
    T_map_insertion_ = T_map_base;
  }
  last_ = evaluate::truth::StampedPose{scan.end, T_map_base};
  return last_;
}

MapContent PclMethod::content() const {
  MapContent content;
  content.points = static_cast<std::int64_t>(parts_->all.size());
  content.bytes_per_point = sizeof(pcl::PointXYZ);
  content.square_metres = static_cast<double>(parts_->all_flat.size()) * 0.12 * 0.12;
  content.local_elements = static_cast<std::int64_t>(parts_->local->size());
  return content;
}

}  // namespace curbstone::bench::mapping::methods
