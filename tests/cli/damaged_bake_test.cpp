// Any byte of a bake that is not as it was written is told, or harms nothing: for every kind of
// bake and every file of it. All bytes of headers and manifests, and some of the others; all of
// them with RIMLIGHT_EVERY_FAULT=1 (script/durability).
#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <memory>
#include <string>

#include "core/base/files.h"
#include "core/curves/curve_layer.h"
#include "core/math/random.h"
#include "core/relight/frame_renderer.h"
#include "core/vertices/vertex_renderer.h"
#include "tests/support/error_of.h"
#include "tests/support/small_curve_bake.h"
#include "tests/support/small_vertex_bake.h"
#include "tests/support/temporary_folder.h"

namespace rimlight {
namespace {

namespace fs = std::filesystem;

/// A prime: of no alignment.
constexpr std::size_t kStride = 997;

std::size_t stride() { return std::getenv("RIMLIGHT_EVERY_FAULT") == nullptr ? kStride : 1; }

/// What `rimlight render` shows of a bake of whatever kind.
std::vector<std::uint8_t> picture_of(const fs::path& folder) {
  FrameReport report;
  Rgb8Image frame;
  if (bake_kind(folder) == kVertexKind) {
    const auto scene =
        std::make_shared<const VertexScene>(vertex_scene_of(std::make_shared<VertexBake>(folder)));
    VertexRenderer renderer(scene, {});
    renderer.render_exact({scene->environments.front().environment->name(), {}}, frame, report);
  } else {
    const auto bake = std::make_shared<const Bake>(folder);
    FrameRenderer renderer(bake, {}, curve_layer_of(bake));
    renderer.render_exact({bake->environments().front().environment->name(), {}}, frame, report);
  }
  return {frame.bytes.begin(), frame.bytes.end()};
}

/// One byte of a file, changed as long as this lives.
class DamagedByte {
 public:
  DamagedByte(const fs::path& path, std::size_t at, unsigned mask)
      : file_(::open(path.c_str(), O_RDWR | O_CLOEXEC)), at_(static_cast<off_t>(at)) {
    EXPECT_EQ(::pread(file_, &good_, 1, at_), 1);
    put(static_cast<std::uint8_t>(good_ ^ mask));
  }
  DamagedByte(const DamagedByte&) = delete;
  DamagedByte& operator=(const DamagedByte&) = delete;
  ~DamagedByte() {
    put(good_);
    ::close(file_);
  }

 private:
  void put(std::uint8_t byte) { EXPECT_EQ(::pwrite(file_, &byte, 1, at_), 1); }

  int file_;
  off_t at_;
  std::uint8_t good_ = 0;
};

/// Up to where every byte is changed: the whole manifest, a tensor file's header.
std::size_t header_bytes(const fs::path& file) {
  const std::string bytes = read_file(file, std::size_t{1} << 26);
  if (file.extension() != ".safetensors") return bytes.size();
  std::uint64_t length = 0;
  std::memcpy(&length, bytes.data(), sizeof length);
  return sizeof length + length;
}

class DamagedBake : public testing::TestWithParam<const char*> {
 protected:
  void SetUp() override {
    const std::string kind = GetParam();
    if (kind == kImageKind) test::write_small_bake(path_, {});
    if (kind == kCurveKind) test::write_curve_bake(path_, test::CurveBakeParts());
    if (kind == kVertexKind) test::write_vertex_bake(path_, test::small_vertex_parts({}));
    ASSERT_EQ(bake_kind(path_), kind);
  }

  test::TemporaryFolder folder_;
  const fs::path path_ = folder_ / "a.bake";
};

TEST_P(DamagedBake, IsToldWhateverByteIsAnother) {
  const auto good = picture_of(path_);
  ASSERT_FALSE(good.empty());
  std::size_t told = 0, harmless = 0, files = 0;
  for (const auto& entry : fs::directory_iterator(path_)) {
    const std::string name = entry.path().filename().string();
    const std::string named = name == kManifestHashFile ? kManifestFile : name;
    const std::size_t size = fs::file_size(entry.path()), header = header_bytes(entry.path());
    Random masks(++files);
    for (std::size_t at = 0; at < size; at += at < header ? 1 : stride()) {
      const DamagedByte damaged(entry.path(), at, 1 + static_cast<unsigned>(masks.below(255)));
      std::vector<std::uint8_t> shown;
      const std::string error = test::error_of([&] { shown = picture_of(path_); });
      if (error != "no error") {
        ++told;
        ASSERT_THAT(error, testing::HasSubstr(named)) << "byte " << at;
        ASSERT_THAT(error, testing::HasSubstr("expected")) << "byte " << at;
      } else {
        ++harmless;
        ASSERT_EQ(shown, good) << name << ", byte " << at << ": another picture, and no error";
        // No picture needs it, but `rimlight inspect --verify` tells it.
        ASSERT_NE(test::error_of([&] { BakeFiles(path_).verify(); }), "no error")
            << name << ", byte " << at;
      }
    }
  }
  std::printf("%s: of %zu damaged bytes in %zu files %zu were told, %zu harmless\n", GetParam(),
              told + harmless, files, told, harmless);
  EXPECT_GT(told, 3000u);
  EXPECT_EQ(picture_of(path_), good);
}

INSTANTIATE_TEST_SUITE_P(Kinds, DamagedBake, testing::Values(kImageKind, kVertexKind, kCurveKind),
                         [](const auto& tested) { return std::string(tested.param); });

}  // namespace
}  // namespace rimlight
