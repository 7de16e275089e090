#include "core/relight/prepared_environment.h"

#include <map>
#include <mutex>
#include <tuple>
#include <utility>

namespace rimlight {
namespace {

using Prepared = std::shared_ptr<const PreparedEnvironment>;

/// All that has been made, as long as its environment lives.
class Store {
 public:
  Prepared find(const std::shared_ptr<const Environment>& environment, const PreparedSizes& sizes) {
    const std::lock_guard lock(mutex_);
    const auto found = entries_.find(key_of(environment.get(), sizes));
    // An expired owner's address may belong to another environment by now.
    if (found == entries_.end() || found->second.owner.lock() != environment) return nullptr;
    return found->second.prepared;
  }

  /// Keeps what is there already, so that all share one.
  Prepared put(const std::shared_ptr<const Environment>& environment, const PreparedSizes& sizes,
               Prepared made) {
    const std::lock_guard lock(mutex_);
    std::erase_if(entries_, [](const auto& item) { return item.second.owner.expired(); });
    return entries_
        .try_emplace(key_of(environment.get(), sizes), Entry{environment, std::move(made)})
        .first->second.prepared;
  }

 private:
  using Key = std::tuple<const Environment*, int, int>;
  static Key key_of(const Environment* environment, const PreparedSizes& sizes) {
    return {environment, sizes.light, sizes.background};
  }

  struct Entry {
    std::weak_ptr<const Environment> owner;
    Prepared prepared;
  };
  std::mutex mutex_;
  std::map<Key, Entry> entries_;
};

Store& store() {
  static Store instance;
  return instance;
}

}  // namespace

Prepared prepare_environment(const std::shared_ptr<const Environment>& environment,
                             const PreparedSizes& sizes) {
  if (auto found = store().find(environment, sizes)) return found;
  // Outside the lock: a thread that waits in a parallel loop may take up work that comes here too.
  auto made = std::make_shared<const PreparedEnvironment>(PreparedEnvironment{
      environment->project(sizes.light), BackgroundMap(environment->project(sizes.background))});
  return store().put(environment, sizes, std::move(made));
}

}  // namespace rimlight
