#pragma once

#include <chrono>
#include <cstddef>
#include <memory>
#include <stop_token>
#include <string>
#include <string_view>
#include <vector>

#include "core/light/environment.h"

namespace rimlight::server {

/// Uploaded files are not larger than this.
inline constexpr std::size_t kLargestUpload = std::size_t{32} << 20;
/// Texels a side of the cube map that is kept of one: that behind the pixels.
inline constexpr int kUploadedSize = 256;

/// How uploads are decoded: by this program itself, in a process of its own.
struct DecoderSettings {
  std::vector<std::string> command{"/proc/self/exe", "decode-environment"};
  std::chrono::milliseconds deadline{30'000};
  std::stop_token stop = {};  // ends it before
};

/// The child's part: shuts itself in (enter_sandbox), reads an .hdr or .exr from standard input and
/// writes its cube map to standard output: 6 × 256 × 256 texels in a strip
/// (EnvironmentLayout::cube, 6×1), rows from the top, three floats each, in this machine's order.
/// Returns the exit status; at 1 standard error says why.
int decode_environment();

/// The parent's: the environment in a file's bytes. Throws Error saying why there is none: neither
/// format, what the decoder says, or a decoder that took too long, too much memory or was killed.
/// Waits for the child. Any thread.
std::shared_ptr<const Environment> decode_uploaded(const std::string& name, std::string_view bytes,
                                                   const DecoderSettings& settings);

}  // namespace rimlight::server
