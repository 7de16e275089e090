#include "server/upload/decoded_environment.h"

#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <new>
#include <span>

#include "core/base/error.h"
#include "core/base/parallel.h"
#include "core/basis/cube_map.h"
#include "core/image/image_file.h"
#include "core/light/environment_samples.h"
#include "server/upload/child_process.h"
#include "server/upload/sandbox.h"

namespace rimlight::server {
namespace {

constexpr auto kSide = static_cast<std::size_t>(kUploadedSize);
constexpr std::size_t kBytes = 6 * kSide * kSide * sizeof(Vec3f);
constexpr const char* kExpected = "a .hdr or .exr picture";

bool is_exr(std::string_view bytes) { return bytes.starts_with("\x76\x2f\x31\x01"); }
bool is_hdr(std::string_view bytes) { return bytes.starts_with("#?"); }

std::string read_all(std::size_t most) {
  std::string bytes(most + 1, '\0');
  std::size_t size = 0;
  while (size < bytes.size()) {
    const ssize_t n = ::read(STDIN_FILENO, bytes.data() + size, bytes.size() - size);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) break;
    size += static_cast<std::size_t>(n);
  }
  if (size > most) throw Error("upload", "more bytes", std::to_string(most) + " at most");
  bytes.resize(size);
  return bytes;
}

bool write_all(std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t n = ::write(STDOUT_FILENO, bytes.data(), bytes.size());
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return false;
    bytes.remove_prefix(static_cast<std::size_t>(n));
  }
  return true;
}

RgbImage decode(std::string_view bytes) {
  const auto raw = std::as_bytes(std::span(bytes));
  RgbImage image = is_exr(bytes) ? decode_exr(raw, "upload") : decode_hdr(raw, "upload");
  for (Vec3f& pixel : image.pixels) {  // as read_radiance() does
    for (int c = 0; c < 3; ++c) pixel[c] = std::max(pixel[c], 0.0f);
  }
  return image;
}

/// The faces beside each other, as the layout looks at them: each pixel is one texel.
RgbImage strip_of(const Environment& environment) {
  const CubeLight light = environment.project(kUploadedSize);
  RgbImage strip(6 * kUploadedSize, kUploadedSize);
  for (const CubeLayoutFace& face : find_cube_layout(strip.width, strip.height)->faces) {
    for (int y = 0; y < kUploadedSize; ++y) {
      for (int x = 0; x < kUploadedSize; ++x) {
        const double s = (2 * x + 1.0) / kUploadedSize - 1;
        const double t = 1 - (2 * y + 1.0) / kUploadedSize;
        const Vec3d direction = face.forward + face.right * s + face.up * t;
        strip.at(face.column * kUploadedSize + x, y) =
            light.at(cube::texel_of(direction, kUploadedSize));
      }
    }
  }
  return strip;
}

int fail(const char* why) {
  std::fprintf(stderr, "%s", why);
  return 1;
}

}  // namespace

int decode_environment() {
  try {
    set_thread_count(1);
    enter_sandbox();
    const RgbImage strip = strip_of(Environment("upload", decode(read_all(kLargestUpload))));
    return write_all({reinterpret_cast<const char*>(strip.pixels.data()), kBytes}) ? 0 : 1;
  } catch (const Error& error) {
    return fail(error.what());
  } catch (const std::bad_alloc&) {
    return fail("upload: found a picture that needs too much memory, expected a smaller one");
  } catch (const std::exception& error) {
    return fail(error.what());
  }
}

std::shared_ptr<const Environment> decode_uploaded(const std::string& name, std::string_view bytes,
                                                   const DecoderSettings& settings) {
  if (!is_exr(bytes) && !is_hdr(bytes)) throw Error("upload", "another format", kExpected);
  const ChildResult result =
      run_child({settings.command, settings.deadline, kBytes, settings.stop}, bytes);
  switch (result.end) {
    case ChildResult::End::too_late:
      throw Error("upload", "a picture that takes too long to decode", "a smaller one");
    case ChildResult::End::killed:
      throw Error("upload", "a picture that takes too much time or memory to decode", kExpected);
    case ChildResult::End::too_much_output:
      throw Error("upload", "a picture that its decoder failed on", kExpected);
    case ChildResult::End::exited:
      break;
  }
  if (result.status == 1 && !result.message.empty()) {
    throw Error("upload", result.message, kExpected);
  }
  if (result.status != 0 || result.output.size() != kBytes) {
    throw Error("upload", "a picture that its decoder failed on", kExpected);
  }
  RgbImage strip(6 * kUploadedSize, kUploadedSize);
  std::memcpy(strip.pixels.data(), result.output.data(), kBytes);
  // Checks that every radiance is finite and not negative: the child is not believed.
  return std::make_shared<const Environment>(name, std::move(strip), EnvironmentLayout::cube);
}

}  // namespace rimlight::server
