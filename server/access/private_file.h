#pragma once

#include <cstddef>
#include <filesystem>
#include <string>

namespace rimlight::server {

/// A file descriptor that closes itself.
class Descriptor {
 public:
  /// Opens, with mode 0600 where the file is made. Throws Error naming the file; `expected` is what
  /// it should be ("a file of signing keys").
  Descriptor(const std::filesystem::path& file, int flags, const char* expected);
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  ~Descriptor();
  int number() const { return number_; }

 private:
  int number_;
};

/// The bytes of a file that holds a secret. Throws Error naming the file: not a regular one,
/// another's than this user's or root's, one that group or others may read or write, or larger than
/// `most` bytes. Errors never contain its bytes.
std::string read_private_file(const std::filesystem::path& file, std::size_t most,
                              const char* expected);

}  // namespace rimlight::server
