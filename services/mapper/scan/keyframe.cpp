#include "services/mapper/scan/keyframe.hpp"

#include <stdexcept>

#include "common/packing/value_packer.hpp"

namespace curbstone::mapper::scan {

std::shared_ptr<const KeyframePoints::Points> KeyframePoints::read() const {
  if (here_) return here_;
  auto points = std::make_shared<Points>();
  if (away_.empty()) return points;
  try {
    ValueUnpacker unpacker(away_.read());
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
  here.here_ = read();
  here.size_ = here.here_->size();
  return here;
}

void KeyframePoints::put_away(SpillFile& file) {
  if (!here_ || empty()) return;
  ValuePacker packer;
  packer.put_steps(*here_, &KeyframePoint::x);
  packer.put_steps(*here_, &KeyframePoint::y);
  packer.put_steps(*here_, &KeyframePoint::z);
  away_ = file.put(packer.pack());
  here_.reset();
}

}  // namespace curbstone::mapper::scan
