#include "drivers/encoder/canopen/sdo_client.hpp"

#include <utility>

#include "common/bytes/little_endian.hpp"

namespace curbstone::encoder::canopen {

using canopen::Object;
using canopen::SdoCommand;

namespace {

/// Number of data bytes of an expedited read reply; 0 for everything else.
int reply_size(SdoCommand command) {
  switch (command) {
    case SdoCommand::kReadReply1:
      return 1;
    case SdoCommand::kReadReply2:
      return 2;
    case SdoCommand::kReadReply3:
      return 3;
    case SdoCommand::kReadReply4:
    case SdoCommand::kReadReplyUnsized:
      return 4;
    default:
      return 0;
  }
}

}  // namespace

void SdoClient::read(std::int64_t now, Object object, Done done) {
  begin(now, object, SdoCommand::kRead, 0, std::move(done));
}

void SdoClient::write(std::int64_t now, Object object, std::uint8_t size, std::uint32_t value, Done done) {
  const SdoCommand command = size == 1 ? SdoCommand::kWrite1 : size == 2 ? SdoCommand::kWrite2 : SdoCommand::kWrite4;
  begin(now, object, command, value, std::move(done));
}

void SdoClient::begin(std::int64_t now, Object object, SdoCommand command, std::uint32_t value, Done done) {
  pending_ =
      Pending{object, canopen::sdo(canopen::kSdoRequest + node_, command, object, value), std::move(done), now, 0};
  counters_.add("sdo.requests");
  send_request(now);
}

void SdoClient::send_request(std::int64_t now) {
  pending_->sent = now;
  ++pending_->tries;
  send_(pending_->request);
}

void SdoClient::on_frame(std::int64_t now, const can::CanFrame& frame) {
  const bool well_formed = frame.size == 8 && !frame.remote;
  const Object object =
      well_formed ? Object{read_little_endian<std::uint16_t>(frame.bytes().subspan(1)), frame.data[3]} : Object{};
  if (!well_formed || !pending_ || object != pending_->object) {
    counters_.add("ignored.sdo");
    return;
  }
  const auto command = static_cast<SdoCommand>(frame.data[0]);
  const auto value = read_little_endian<std::uint32_t>(frame.bytes().subspan(4));
  const bool reading = static_cast<SdoCommand>(pending_->request.data[0]) == SdoCommand::kRead;
  if (command == SdoCommand::kAbort) {
    counters_.add("sdo.aborts");
    finish(now, {Result::Status::kAborted, value});
  } else if (const int size = reply_size(command); reading && size > 0) {
    finish(now, {Result::Status::kOk, size == 4 ? value : value & ((1u << (8 * size)) - 1)});
  } else if (!reading && command == SdoCommand::kWriteReply) {
    finish(now, {Result::Status::kOk, 0});
  } else {
    counters_.add("ignored.sdo");
  }
}

void SdoClient::tick(std::int64_t now) {
  if (!pending_ || (now - pending_->sent < kAnswerTime && now >= pending_->sent)) return;
  send_(canopen::sdo(canopen::kSdoRequest + node_, SdoCommand::kAbort, pending_->object, canopen::kAbortTimeout));
  if (pending_->tries >= kMaxTries) {
    counters_.add("sdo.timeouts");
    finish(now, {Result::Status::kNoAnswer, 0});
  } else {
    counters_.add("sdo.retries");
    send_request(now);
  }
}

void SdoClient::finish(std::int64_t now, const Result& result) {
  const Done done = std::move(pending_->done);
  pending_.reset();
  done(now, result);
}

}  // namespace curbstone::encoder::canopen
