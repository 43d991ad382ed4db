#include "services/mapper/scan/keyframe.hpp"

#include <stdexcept>

#include "common/packing/value_packer.hpp"

namespace curbstone::mapper::scan {

std::shared_ptr<const KeyframePoints::Points> KeyframePoints::read() const {
  if (points_) return points_;
  auto points = std::make_shared<Points>();
  if (spilled_.empty()) return points;
  try {
    ValueUnpacker unpacker(spilled_.read());
    unpacker.take_steps(*points, &KeyframePoint::x);
    unpacker.take_steps(*points, &KeyframePoint::y);
    unpacker.take_steps(*points, &KeyframePoint::z);
  } catch (const std::runtime_error&) {
    points->clear();
  }
  return points;
}

KeyframePoints KeyframePoints::in_memory() const {
  KeyframePoints here;
  here.points_ = read();
  here.size_ = here.points_->size();
  return here;
}

void KeyframePoints::spill(SpillFile& file) {
  if (!points_ || empty()) return;
  ValuePacker packer;
  packer.put_steps(*points_, &KeyframePoint::x);
  packer.put_steps(*points_, &KeyframePoint::y);
  packer.put_steps(*points_, &KeyframePoint::z);
  spilled_ = file.put(packer.pack());
  points_.reset();
}

}  // namespace curbstone::mapper::scan
