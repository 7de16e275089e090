#include "server/session/session_users.h"

#include <algorithm>

#include "server/access/resume_token.h"

namespace rimlight::server {
namespace {

std::string guest_name(std::int64_t number) { return "guest " + std::to_string(number); }

}  // namespace

SessionUsers::SessionUsers(const SessionVersion& version) {
  last_number_ = version.author.number;
  for (const auto& [number, editor] : version.editors) {
    const bool is_guest = editor.name == guest_name(number);
    users_[number] = {is_guest ? std::string() : editor.name,
                      {{number, editor.name}, editor.token_hash}};
    last_number_ = std::max(last_number_, number);
  }
  for (const auto& [name, snapshot] : version.snapshots) {
    last_number_ = std::max(last_number_, snapshot->author.number);
  }
}

SessionUsers::Entered SessionUsers::enter(const Client& client, const Visitor& visitor) {
  Entered entered;
  auto found = users_.end();
  if (is_resume_token(visitor.resume)) {
    // Hashes are looked up: how long that takes tells nothing about a token of 256 random bits.
    found = std::ranges::find_if(users_, [hash = resume_token_hash(visitor.resume),
                                          &visitor](const auto& entry) {
      return entry.second.contributor.token_hash == hash && entry.second.given_name == visitor.name;
    });
  }
  if (found != users_.end()) {
    entered.resume = visitor.resume;
    entered.resumed = true;
  } else {
    const std::int64_t number = ++last_number_;
    entered.resume = make_resume_token();
    const std::string name = visitor.name.empty() ? guest_name(number) : visitor.name;
    found = users_
                .emplace(number,
                         User{visitor.name, {{number, name}, resume_token_hash(entered.resume)}})
                .first;
  }
  User& user = found->second;
  user.role = visitor.role;
  ++user.clients;
  clients_[&client] = found->first;
  entered.user = user.contributor;
  forget_old();
  return entered;
}

void SessionUsers::leave(const Client& client) {
  const auto found = clients_.find(&client);
  if (found == clients_.end()) return;
  User& user = users_.at(found->second);
  --user.clients;
  user.left = ++departures_;
  clients_.erase(found);
}

Contributor SessionUsers::of(const Client& client) const {
  const auto found = clients_.find(&client);
  return found == clients_.end() ? Contributor{} : users_.at(found->second).contributor;
}

std::vector<Present> SessionUsers::present() const {
  std::vector<Present> present;
  for (const auto& [number, user] : users_) {
    if (user.clients > 0) present.push_back({user.contributor.author, user.role});
  }
  return present;
}

void SessionUsers::forget_old() {
  while (users_.size() > kMostKnown) {
    auto oldest = users_.end();
    for (auto user = users_.begin(); user != users_.end(); ++user) {
      if (user->second.clients > 0) continue;
      if (oldest == users_.end() || user->second.left < oldest->second.left) oldest = user;
    }
    if (oldest == users_.end()) return;  // all are there
    users_.erase(oldest);
  }
}

}  // namespace rimlight::server
