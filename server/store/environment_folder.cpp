#include "server/store/environment_folder.h"

#include <openssl/evp.h>
#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>
#include <system_error>
#include <utility>

#include "core/base/error.h"
#include "core/base/files.h"
#include "core/base/json_reader.h"
#include "core/image/image_file.h"
#include "server/log/event_log.h"

namespace rimlight::server {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kLargestList = 64 * 1024;
constexpr const char* kExpected = "a list of uploaded environments";

struct Listed {
  std::string name;
  std::string hash;
};

std::string hash_of(const RgbImage& image) {
  unsigned char digest[EVP_MAX_MD_SIZE];
  unsigned size = 0;
  EVP_Digest(image.pixels.data(), image.pixels.size() * sizeof(Vec3f), digest, &size, EVP_sha256(),
             nullptr);
  std::string text;
  for (unsigned i = 0; i < size; ++i) {
    constexpr const char* kDigits = "0123456789abcdef";
    text += kDigits[digest[i] >> 4];
    text += kDigits[digest[i] & 15];
  }
  return text;
}

bool is_hash(const std::string& text) {
  return text.size() == 64 && text.find_first_not_of("0123456789abcdef") == std::string::npos;
}

std::vector<Listed> read_list(const fs::path& file) {
  std::error_code ignored;
  if (!fs::exists(file, ignored)) return {};
  const nlohmann::json document = parse_json(read_file(file, kLargestList), file.string());
  const JsonReader reader(document, file.string());
  reader.allow_only({"environments"});
  std::vector<Listed> list;
  for (const JsonReader& one : reader.member("environments").elements(0, kMostUploads)) {
    one.allow_only({"name", "sha256"});
    Listed listed{one.member("name").string(), one.member("sha256").string()};
    if (!is_hash(listed.hash)) throw Error(one.where(), quote(listed.hash), kExpected);
    list.push_back(std::move(listed));
  }
  return list;
}

std::string write_list(const std::vector<Listed>& list) {
  nlohmann::json text{{"environments", nlohmann::json::array()}};
  for (const Listed& one : list) {
    text["environments"].push_back({{"name", one.name}, {"sha256", one.hash}});
  }
  return text.dump(2) + "\n";
}

EnvironmentPtr read_environment(const fs::path& folder, const Listed& listed) {
  RgbImage image = read_radiance(folder / (listed.hash + ".exr"));
  if (hash_of(image) != listed.hash) {
    throw Error((folder / (listed.hash + ".exr")).string(), "other radiance", "that of its name");
  }
  return std::make_shared<const Environment>(listed.name, std::move(image),
                                             EnvironmentLayout::cube);
}

}  // namespace

EnvironmentFolder::EnvironmentFolder(fs::path folder, std::uint64_t most_bytes)
    : folder_(std::move(folder)), most_bytes_(most_bytes) {
  std::error_code failure;
  fs::create_directories(folder_, failure);
  if (failure) throw Error(folder_.string(), failure.message(), "a folder for uploads");
}

/// Names have no @, so that no two sessions share a file, and none is hidden or above.
fs::path EnvironmentFolder::list_of(const std::string& scene, const std::string& session) const {
  return folder_ / (scene + "@" + session + ".json");
}

std::uint64_t EnvironmentFolder::bytes() const {
  std::uint64_t sum = 0;
  std::error_code failure;
  for (auto entry = fs::directory_iterator(folder_, failure);
       !failure && entry != fs::directory_iterator(); entry.increment(failure)) {
    std::error_code vanished;
    const std::uint64_t size = entry->file_size(vanished);
    if (!vanished) sum += size;
  }
  return sum;
}

std::vector<EnvironmentPtr> EnvironmentFolder::load(const std::string& scene,
                                                    const std::string& session) const {
  const std::lock_guard lock(mutex_);
  std::vector<EnvironmentPtr> environments;
  try {
    for (const Listed& listed : read_list(list_of(scene, session))) {
      try {
        environments.push_back(read_environment(folder_, listed));
      } catch (const Error& error) {
        log_event(Severity::warning, "environment_lost", {{"detail", error.what()}});
      }
    }
  } catch (const Error& error) {
    log_event(Severity::warning, "environments_lost", {{"detail", error.what()}});
  }
  return environments;
}

void EnvironmentFolder::add(const std::string& scene, const std::string& session,
                            const Environment& environment) {
  const std::lock_guard lock(mutex_);
  const RgbImage& image = environment.image();
  const std::string hash = hash_of(image);
  const fs::path file = folder_ / (hash + ".exr");
  std::error_code ignored;
  if (!fs::exists(file, ignored)) {
    if (bytes() + image.pixels.size() * sizeof(Vec3f) > most_bytes_) {
      throw Error("uploads", "a store that is full", "room: ask who runs the server");
    }
    write_exr(file, image);
  }
  std::vector<Listed> list = read_list(list_of(scene, session));
  std::erase_if(list, [&](const Listed& one) { return one.name == environment.name(); });
  list.push_back({environment.name(), hash});
  write_file_atomically(list_of(scene, session), write_list(list));
}

void EnvironmentFolder::remove(const std::string& scene, const std::string& session,
                               const std::string& name) {
  const std::lock_guard lock(mutex_);
  std::vector<Listed> list = read_list(list_of(scene, session));
  std::erase_if(list, [&](const Listed& one) { return one.name == name; });
  write_file_atomically(list_of(scene, session), write_list(list));
  collect_locked();
}

void EnvironmentFolder::remove_all(const std::string& scene, const std::string& session) {
  const std::lock_guard lock(mutex_);
  std::error_code failure;
  const bool was_there = fs::remove(list_of(scene, session), failure);
  if (failure) throw Error(list_of(scene, session).string(), failure.message(), "a disk");
  if (was_there) collect_locked();
}

std::size_t EnvironmentFolder::collect() {
  const std::lock_guard lock(mutex_);
  return collect_locked();
}

/// Where a list cannot be read nothing is deleted: it may name anything.
std::size_t EnvironmentFolder::collect_locked() {
  std::set<std::string> listed;
  std::vector<fs::path> pictures;
  try {
    for (const fs::directory_entry& entry : fs::directory_iterator(folder_)) {
      const fs::path& file = entry.path();
      if (file.extension() == ".exr" && is_hash(file.stem().string())) pictures.push_back(file);
      if (file.extension() != ".json") continue;
      for (const Listed& one : read_list(file)) listed.insert(one.hash);
    }
  } catch (const std::exception& error) {  // Error, or of the directory
    log_event(Severity::warning, "environments_not_collected", {{"detail", error.what()}});
    return 0;
  }
  std::size_t deleted = 0;
  for (const fs::path& file : pictures) {
    std::error_code ignored;
    if (!listed.contains(file.stem().string())) deleted += fs::remove(file, ignored) ? 1 : 0;
  }
  return deleted;
}

}  // namespace rimlight::server
