#pragma once

#include <array>

namespace rimlight::server {

/// Why a request, a connection or a message was not taken: what metrics and logs call it. What else
/// is said of it is in the log, for people.
enum class RefusalReason {
  malformed,          // no HTTP
  tls,                // no handshake, or none that can be agreed on
  host,               // no Host, more than one, or that of another server
  body,               // where none is taken
  upload,             // of an environment: its length, its name, or what it holds; or too many
  method,             // other than GET and HEAD
  not_found,          // no such path, scene or session
  origin,             // a page of another origin
  token,              // missing, or not believed
  forbidden,          // a token for something else
  too_many_sockets,   // connections in all
  too_many_sessions,  // all in use
  store,              // it cannot be read
  stopping,           // the server is
  rate,               // messages a second
  message,            // one that cannot be read, or names what is not there
};
inline constexpr std::array kRefusalReasons = {RefusalReason::malformed,
                                               RefusalReason::tls,
                                               RefusalReason::host,
                                               RefusalReason::body,
                                               RefusalReason::upload,
                                               RefusalReason::method,
                                               RefusalReason::not_found,
                                               RefusalReason::origin,
                                               RefusalReason::token,
                                               RefusalReason::forbidden,
                                               RefusalReason::too_many_sockets,
                                               RefusalReason::too_many_sessions,
                                               RefusalReason::store,
                                               RefusalReason::stopping,
                                               RefusalReason::rate,
                                               RefusalReason::message};
const char* to_string(RefusalReason reason);

/// How a WebSocket ended.
enum class CloseReason {
  client_closed,      // with the closing handshake
  client_lost,        // without
  handshake_failed,   // before the upgrade was done
  silent,             // no answer to a ping
  message_too_large,  // above the limit of bytes
  not_utf8,           // a text that is none
  too_many_messages,  // far above the rate
  not_reading,        // too many replies wait
  edits_unstored,     // its edits wait for the disk too long
  token_expired,
  server_stopped,
  session_deleted,  // by one of its owners
};
inline constexpr std::array kCloseReasons = {
    CloseReason::client_closed,     CloseReason::client_lost,
    CloseReason::handshake_failed,  CloseReason::silent,
    CloseReason::message_too_large, CloseReason::not_utf8,
    CloseReason::too_many_messages, CloseReason::not_reading,
    CloseReason::edits_unstored,    CloseReason::token_expired,
    CloseReason::server_stopped,    CloseReason::session_deleted};
const char* to_string(CloseReason reason);

}  // namespace rimlight::server
