#include "server/session/session_environments.h"

#include <algorithm>
#include <utility>

#include "core/base/error.h"

namespace rimlight::server {

SessionEnvironments::SessionEnvironments(std::vector<std::string> of_scene,
                                         const std::vector<EnvironmentPtr>& uploaded)
    : of_scene_(std::move(of_scene)) {
  for (const EnvironmentPtr& one : uploaded) {
    try {
      add(one);
    } catch (const Error&) {  // the scene has got one of that name since
    }
  }
}

std::vector<std::string> SessionEnvironments::names() const {
  std::vector<std::string> names = of_scene_;
  const std::lock_guard lock(mutex_);
  for (const EnvironmentPtr& one : uploaded_) names.push_back(one->name());
  return names;
}

EnvironmentPtr SessionEnvironments::find_uploaded(const std::string& name) const {
  const std::lock_guard lock(mutex_);
  const auto found = std::ranges::find_if(
      uploaded_, [&](const EnvironmentPtr& one) { return one->name() == name; });
  return found == uploaded_.end() ? nullptr : *found;
}

void SessionEnvironments::check_room(const std::string& name) const {
  if (std::ranges::find(of_scene_, name) != of_scene_.end() || find_uploaded(name)) {
    throw Error("URL", "the environment " + quote(name) + ", which is there", "another name");
  }
  const std::lock_guard lock(mutex_);
  if (uploaded_.size() >= kMostUploads) {
    throw Error("session", std::to_string(uploaded_.size()) + " uploaded environments",
                "fewer: it has all that it may");
  }
}

bool SessionEnvironments::remove(const std::string& name) {
  const std::lock_guard lock(mutex_);
  return std::erase_if(uploaded_, [&](const EnvironmentPtr& one) { return one->name() == name; }) >
         0;
}

void SessionEnvironments::add(EnvironmentPtr environment) {
  check_room(environment->name());
  const std::lock_guard lock(mutex_);
  uploaded_.push_back(std::move(environment));
}

}  // namespace rimlight::server
