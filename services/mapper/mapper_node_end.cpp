#include <utility>

#include "services/mapper/mapper_node.hpp"

/// @file
/// MapperNode: the end of the drive.

namespace curbstone::mapper {

void MapperNode::end_drive() {
  if (std::exchange(is_over_, true)) return;
  input_.flush();
  while (!input_.empty()) process(input_.pop());
  if (epoch_ == 0) return;
  take_changes(last_end_);
  const bool is_rearranged = mapper_->close_last_loop();
  if (const bool is_another = mapper_->show_drive(); is_another || is_rearranged) {
    name_epoch(last_end_ + 1);
    begin_epoch(last_end_ + 1, is_rearranged);
  }
  sender_.queue_tiles(mapper_->finish());
  send_index(last_end_);
}

/// What is queued and requested after the end of the drive. The map no longer changes.
void MapperNode::send_rest(std::int64_t now) {
  if (epoch_ == 0) return;
  sender_.send_trajectory();
  send_due_index(now);
  sender_.send_changes(mapper_->dense(), now);
  sender_.send_requested(mapper_->dense());
}

void MapperNode::finish() {
  end_drive();
  if (epoch_ == 0) return;
  sender_.finish(mapper_->dense());
  send_index(last_end_);
  keep_map_at_the_end();
  if (journal_) journal_->remove();
}

}  // namespace curbstone::mapper
