#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "server/access/access_token.h"
#include "server/session/session_version.h"

namespace rimlight::server {

class Client;

/// Who comes to a session, as the connection knows it.
struct Visitor {
  std::string name = {};  // the access token's; may be empty
  Role role = Role::owner;
  std::string resume = {};                // a resume token, or empty
  std::optional<std::int64_t> seen = {};  // the number of the last revision that it had
  bool parts = false;                     // Display::parts, until it says more
};

/// The users of one session: who has it open, and whom a resume token makes one again. A user is
/// named by the access token, else "guest N". One thread at a time: the session's mutex.
class SessionUsers {
 public:
  /// So many are known; of those who are away, the ones who left first are forgotten.
  static constexpr std::size_t kMostKnown = 256;

  /// Those who have edited are known already.
  explicit SessionUsers(const SessionVersion& version);

  struct Entered {
    Contributor user;
    std::string resume;  // the token that the client has from now on
    bool resumed = false;
  };
  /// A resume token of a user who was called otherwise counts as none.
  Entered enter(const Client& client, const Visitor& visitor);
  void leave(const Client& client);
  /// The user of a client that is there; number 0 for one that is not.
  Contributor of(const Client& client) const;
  /// By number, each once, however many clients it has.
  std::vector<Present> present() const;

 private:
  struct User {
    std::string given_name;  // by the access token
    Contributor contributor;
    Role role = Role::viewer;
    std::size_t clients = 0;
    std::int64_t left = 0;  // counts departures
  };

  void forget_old();

  std::map<std::int64_t, User> users_;
  std::map<const Client*, std::int64_t> clients_;
  std::int64_t last_number_ = 0, departures_ = 0;
};

}  // namespace rimlight::server
