#include "common/resend/resend_client.hpp"

#include <cstdlib>
#include <curbstone/resend_request_t.hpp>

#include "common/resend/recent_messages.hpp"

namespace curbstone {

void ResendClient::ask(std::int64_t now, const std::optional<MissingMessages>& missing) {
  if (!missing) {
    asked_ = {};
    return;
  }
  const bool is_new = missing->before > asked_.before || missing->after >= asked_.before;
  const bool is_coming = !is_new && (missing->after != asked_.after || missing->before != asked_.before);
  asked_ = *missing;
  if (is_coming) asked_at_ = now;
  if (!is_new && std::abs(now - asked_at_) < kRetryAfter) return;
  asked_at_ = now;
  resend_request_t request;
  request.utime = now;
  request.requester = requester_;
  request.channel = channel_;
  request.after = missing->after;
  request.before = missing->before;
  bus_.publish(kResendRequests, request);
}

}  // namespace curbstone
