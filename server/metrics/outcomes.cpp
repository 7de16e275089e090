#include "server/metrics/outcomes.h"

namespace rimlight::server {

const char* to_string(RefusalReason reason) {
  switch (reason) {
    case RefusalReason::malformed:
      return "malformed";
    case RefusalReason::tls:
      return "tls";
    case RefusalReason::host:
      return "host";
    case RefusalReason::body:
      return "body";
    case RefusalReason::upload:
      return "upload";
    case RefusalReason::method:
      return "method";
    case RefusalReason::not_found:
      return "not_found";
    case RefusalReason::origin:
      return "origin";
    case RefusalReason::token:
      return "token";
    case RefusalReason::forbidden:
      return "forbidden";
    case RefusalReason::too_many_sockets:
      return "too_many_sockets";
    case RefusalReason::too_many_sessions:
      return "too_many_sessions";
    case RefusalReason::store:
      return "store";
    case RefusalReason::stopping:
      return "stopping";
    case RefusalReason::rate:
      return "rate";
    case RefusalReason::message:
      return "message";
  }
  return "unknown";
}

const char* to_string(CloseReason reason) {
  switch (reason) {
    case CloseReason::client_closed:
      return "client_closed";
    case CloseReason::client_lost:
      return "client_lost";
    case CloseReason::handshake_failed:
      return "handshake_failed";
    case CloseReason::silent:
      return "silent";
    case CloseReason::message_too_large:
      return "message_too_large";
    case CloseReason::not_utf8:
      return "not_utf8";
    case CloseReason::too_many_messages:
      return "too_many_messages";
    case CloseReason::not_reading:
      return "not_reading";
    case CloseReason::edits_unstored:
      return "edits_unstored";
    case CloseReason::token_expired:
      return "token_expired";
    case CloseReason::server_stopped:
      return "server_stopped";
    case CloseReason::session_deleted:
      return "session_deleted";
  }
  return "unknown";
}

}  // namespace rimlight::server
