#include "core/transport/tensor_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <numeric>
#include <thread>

#include "core/base/check.h"
#include "core/base/files.h"
#include "core/math/random.h"
#include "tests/support/overwrite.h"
#include "tests/support/temporary_folder.h"

namespace rimlight {
namespace {

using test::TemporaryFolder;

/// Four tensors over more than two hashed blocks, of sizes that need padding, one of them empty.
struct Sample {
  std::vector<std::uint8_t> bytes = std::vector<std::uint8_t>(1'000'003);
  std::vector<std::uint16_t> halves = std::vector<std::uint16_t>(3 * 111'111);
  std::vector<float> floats = std::vector<float>(300'001);

  Sample() {
    Random random(1);
    for (auto& value : bytes) value = static_cast<std::uint8_t>(random.bits());
    for (auto& value : halves) value = static_cast<std::uint16_t>(random.bits());
    for (auto& value : floats) value = random.uniform_float();
  }

  TensorFileSummary write(const std::filesystem::path& path) const {
    TensorFileWriter writer(path, {{"bytes", ElementType::u8, {bytes.size()}},
                                   {"nothing", ElementType::u64, {5, 0, 3}},
                                   {"halves", ElementType::f16, {3, 111'111}},
                                   {"floats", ElementType::f32, {floats.size(), 1}}});
    writer.append(std::span<const std::uint8_t>(bytes).first(17));
    writer.append(std::span<const std::uint8_t>(bytes).subspan(17));
    writer.append(std::span<const std::uint16_t>(halves));
    for (const float value : std::span(floats).first(10)) writer.append(std::span(&value, 1));
    writer.append(std::span<const float>(floats).subspan(10));
    return writer.finish();
  }
};

std::string read(const std::filesystem::path& path) { return read_file(path, SIZE_MAX); }

/// Opens a file with these bytes and the right hashes: what a hostile writer could make.
void open_bytes(const std::filesystem::path& path, const std::string& bytes) {
  test::overwrite(path, bytes);
  TensorFileSummary summary{bytes.size(), {}};
  const auto all = std::as_bytes(std::span(bytes));
  for (std::size_t begin = 0; begin < all.size(); begin += kHashedBlock) {
    summary.block_hashes.push_back(
        hash_bytes(all.subspan(begin, std::min(kHashedBlock, all.size() - begin)),
                   summary.block_hashes.size()));
  }
  const TensorFile file(path, summary);
  for (const std::string& name : file.names()) static_cast<void>(file.shape(name));
}

/// A file whose data starts on 64 bytes, if the header allows.
std::string with_header(std::string header, std::size_t data_bytes) {
  if (data_bytes > 0) header.resize((header.size() + 8 + 63) / 64 * 64 - 8, ' ');
  const std::uint64_t length = header.size();
  std::string bytes(sizeof length, '\0');
  std::memcpy(bytes.data(), &length, sizeof length);
  return bytes + header + std::string(data_bytes, '\1');
}

TEST(TensorFile, GivesBackWhatWasWritten) {
  const TemporaryFolder folder;
  const Sample sample;
  const auto summary = sample.write(folder / "a.safetensors");
  EXPECT_EQ(summary.bytes, std::filesystem::file_size(folder / "a.safetensors"));
  const TensorFile file(folder / "a.safetensors", summary);
  EXPECT_THAT(file.names(), testing::ElementsAre("bytes", "floats", "halves", "nothing"));
  EXPECT_THAT(file.tensor<std::uint8_t>("bytes", ElementType::u8),
              testing::ElementsAreArray(sample.bytes));
  EXPECT_THAT(file.tensor<std::uint16_t>("halves", ElementType::f16),
              testing::ElementsAreArray(sample.halves));
  EXPECT_THAT(file.tensor<float>("floats", ElementType::f32),
              testing::ElementsAreArray(sample.floats));
  EXPECT_TRUE(file.tensor<std::uint64_t>("nothing", ElementType::u64).empty());
  EXPECT_THAT(file.shape("nothing"), testing::ElementsAre(5, 0, 3));
  EXPECT_THROW(static_cast<void>(file.tensor<float>("halves", ElementType::f32)), Error);
  EXPECT_THROW(static_cast<void>(file.tensor<float>("other", ElementType::f32)), Error);
  file.verify();
}

TEST(TensorFile, EveryTensorStartsOnACacheLine) {
  const TemporaryFolder folder;
  const Sample sample;
  const TensorFile file(folder / "a.safetensors", sample.write(folder / "a.safetensors"));
  for (const void* data :
       {static_cast<const void*>(file.tensor<std::uint16_t>("halves", ElementType::f16).data()),
        static_cast<const void*>(file.tensor<float>("floats", ElementType::f32).data())}) {
    EXPECT_EQ(reinterpret_cast<std::uintptr_t>(data) % 64, 0u);
  }
}

/// What the safetensors format asks for, read without our reader.
TEST(TensorFile, IsPlainSafetensors) {
  const TemporaryFolder folder;
  Sample().write(folder / "a.safetensors");
  const std::string bytes = read(folder / "a.safetensors");
  std::uint64_t length = 0;
  std::memcpy(&length, bytes.data(), sizeof length);
  EXPECT_EQ(bytes[8], '{');
  const auto header = nlohmann::json::parse(bytes.substr(8, length));
  std::vector<std::pair<std::size_t, std::size_t>> spans;
  for (const auto& [name, tensor] : header.items()) {
    spans.emplace_back(tensor["data_offsets"][0], tensor["data_offsets"][1]);
  }
  std::ranges::sort(spans);
  std::size_t at = 0;
  for (const auto& [begin, end] : spans) {
    EXPECT_EQ(begin, at);
    at = end;
  }
  EXPECT_EQ(8 + length + at, bytes.size());
}

TEST(TensorFile, AFlippedBitAnywhereIsFoundAtFirstTouchOfItsBlock) {
  const TemporaryFolder folder;
  const Sample sample;
  const auto path = folder / "a.safetensors";
  const auto summary = sample.write(path);
  const std::string good = read(path);
  Random random(3);
  int in_floats = 0;
  for (int i = 0; i < 60; ++i) {
    std::string bad = good;
    const std::size_t byte = i < 10 ? static_cast<std::size_t>(i) : random.below(bad.size());
    bad[byte] = static_cast<char>(bad[byte] ^ (1 << random.below(8)));
    test::overwrite(path, bad);
    try {
      const TensorFile file(path, summary);
      EXPECT_GE(byte, kHashedBlock) << "the header's block is touched on opening";
      EXPECT_THROW(file.verify(), Error);
      // "bytes" ends in the first block, "floats" in the last.
      EXPECT_NO_THROW(static_cast<void>(file.tensor<std::uint8_t>("bytes", ElementType::u8)));
      if (byte / kHashedBlock == (bad.size() - 1) / kHashedBlock) {
        ++in_floats;
        EXPECT_THROW(static_cast<void>(file.tensor<float>("floats", ElementType::f32)), Error);
      }
    } catch (const Error& error) {
      EXPECT_LT(byte, kHashedBlock);
      EXPECT_THAT(error.what(), testing::HasSubstr("a.safetensors: block 0"));
    }
  }
  EXPECT_GT(in_floats, 0);
}

TEST(TensorFile, TwoBlocksThatChangePlacesAreFound) {
  const TemporaryFolder folder;
  const auto path = folder / "a.safetensors";
  TensorFileWriter writer(path, {{"zeros", ElementType::u8, {4 * kHashedBlock}}});
  std::vector<std::uint8_t> zeros(4 * kHashedBlock, 0);
  zeros[kHashedBlock + 5] = 1;
  writer.append(std::span<const std::uint8_t>(zeros));
  const auto summary = writer.finish();
  std::string bytes = read(path);
  std::swap_ranges(bytes.begin() + kHashedBlock, bytes.begin() + 2 * kHashedBlock,
                   bytes.begin() + 2 * kHashedBlock);
  test::overwrite(path, bytes);
  EXPECT_THROW(TensorFile(path, summary).verify(), Error);
}

TEST(TensorFile, OfAnotherLengthIsRefused) {
  const TemporaryFolder folder;
  const auto path = folder / "a.safetensors";
  const auto summary = Sample().write(path);
  const std::string good = read(path);
  for (const std::size_t size :
       {std::size_t{0}, std::size_t{7}, std::size_t{100}, good.size() - 1}) {
    test::overwrite(path, good.substr(0, size));
    EXPECT_THROW(TensorFile(path, summary), Error) << size;
  }
  test::overwrite(path, good + "x");
  EXPECT_THROW(TensorFile(path, summary), Error);
  std::filesystem::remove(path);
  EXPECT_THROW(TensorFile(path, summary), Error);
}

TEST(TensorFile, HostileHeadersAreRefusedAndGoodOnesAreNot) {
  const TemporaryFolder folder;
  const auto path = folder / "h.safetensors";
  const auto tensor = [](const std::string& fields) { return "{\"t\":{" + fields + "}}"; };
  const std::string good = tensor(R"("dtype":"F32","shape":[2,2],"data_offsets":[0,16])");
  EXPECT_NO_THROW(open_bytes(path, with_header(good, 16)));
  EXPECT_NO_THROW(open_bytes(path, with_header(R"({"__metadata__":{"a":"b"}})", 0)));
  EXPECT_NO_THROW(open_bytes(path, with_header("{}", 0)));
  const std::vector<std::string> bad = {
      "",
      "[]",
      "{",
      "{}x",
      "null",
      R"({"t":1})",
      tensor(""),
      tensor(R"("dtype":"F32","shape":[2,2],"data_offsets":[0,20])"),
      tensor(R"("dtype":"F32","shape":[2,2],"data_offsets":[0,12])"),
      tensor(R"("dtype":"F32","shape":[4],"data_offsets":[16,0])"),
      tensor(R"("dtype":"F32","shape":[4],"data_offsets":[-16,0])"),
      tensor(R"("dtype":"F32","shape":[4.5],"data_offsets":[0,16])"),
      tensor(R"("dtype":"F32","shape":[-4],"data_offsets":[0,16])"),
      tensor(R"("dtype":"F32","shape":[4],"data_offsets":[0])"),
      tensor(R"("dtype":"F32","shape":[4],"data_offsets":[0,1e30])"),
      tensor(R"("dtype":"F8","shape":[16],"data_offsets":[0,16])"),
      tensor(R"("dtype":"U8","shape":[16],"data_offsets":[0,16],"more":1)"),
      tensor(R"("dtype":"U8","shape":[15],"data_offsets":[1,16])"),
      tensor(R"("dtype":"U8","shape":[15],"data_offsets":[0,15])"),
      tensor(R"("dtype":"F32","shape":[4611686018427387904,4],"data_offsets":[0,16])"),
      tensor(R"("dtype":"F32","shape":[9007199254740992,9007199254740992],"data_offsets":[0,16])"),
      tensor(R"("dtype":"U8","shape":[1,1,1,1,1,1,1,1,16],"data_offsets":[0,16])"),
      R"({"t":{"dtype":"U8","shape":[16],"data_offsets":[0,16]},"t":{"dtype":"U8","shape":[16],"data_offsets":[0,16]}})",
      R"({"a":{"dtype":"U8","shape":[9],"data_offsets":[0,9]},"b":{"dtype":"U8","shape":[8],"data_offsets":[8,16]}})",
      R"({"a":{"dtype":"U8","shape":[7],"data_offsets":[0,7]},"b":{"dtype":"U8","shape":[8],"data_offsets":[8,16]}})",
      R"({"a":{"dtype":"U8","shape":[3],"data_offsets":[0,3]},"b":{"dtype":"F32","shape":[3],"data_offsets":[3,15]},"c":{"dtype":"U8","shape":[1],"data_offsets":[15,16]}})",
  };
  for (const std::string& header : bad) {
    EXPECT_THROW(open_bytes(path, with_header(header, 16)), Error) << header;
  }
}

TEST(TensorFile, AHeaderLongerThanTheLimitOrTheFileIsRefused) {
  const TemporaryFolder folder;
  std::string bytes = with_header("{}", 0);
  for (const std::uint64_t length : {std::uint64_t{3}, std::uint64_t{1} << 40, ~std::uint64_t{0}}) {
    std::memcpy(bytes.data(), &length, sizeof length);
    EXPECT_THROW(open_bytes(folder / "h", bytes), Error) << length;
  }
  const std::string spaces(kMostHeaderBytes + 1 - 2, ' ');
  EXPECT_THROW(open_bytes(folder / "h", with_header("{}" + spaces, 0)), Error);
  EXPECT_NO_THROW(open_bytes(folder / "h", with_header("{}" + spaces.substr(1), 0)));
}

TEST(TensorFile, ManyThreadsMayTouchItAtOnce) {
  const TemporaryFolder folder;
  const Sample sample;
  const TensorFile file(folder / "a", sample.write(folder / "a"));
  std::vector<std::thread> threads;
  std::atomic<int> right = 0;
  for (int t = 0; t < 8; ++t) {
    threads.emplace_back([&] {
      right += file.tensor<float>("floats", ElementType::f32)[7] == sample.floats[7];
      file.verify();
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(right, 8);
}

TEST(TensorFileWriter, RefusesTooMuchAndTooLittle) {
  const TemporaryFolder folder;
  const std::vector<float> values(5);
  {
    TensorFileWriter writer(folder / "a", {{"t", ElementType::f32, {4}}});
    EXPECT_THROW(writer.append(std::span<const float>(values)), CheckFailure);
  }
  {
    TensorFileWriter writer(folder / "a", {{"t", ElementType::f32, {4}}});
    writer.append(std::span<const float>(values).first(3));
    EXPECT_THROW(writer.finish(), CheckFailure);
  }
  EXPECT_THROW(TensorFileWriter(folder / "no" / "such", {}), Error);
}

TEST(TensorFileSummary, GoesThroughJsonAndRefusesWhatItIsNot) {
  const TensorFileSummary summary{2 * kHashedBlock + 1, {0, ~std::uint64_t{0}, 0x0123456789abcdef}};
  const auto json = summary.to_json();
  const auto back = TensorFileSummary::from_json(JsonReader(json, "s"));
  EXPECT_EQ(back.bytes, summary.bytes);
  EXPECT_EQ(back.block_hashes, summary.block_hashes);
  for (const char* text : {R"({"bytes":1,"xxh64":[]})", R"({"bytes":-1,"xxh64":[]})",
                           R"({"bytes":1,"xxh64":["0123"]})", R"({"bytes":0})",
                           R"({"bytes":1,"xxh64":["0123456789abcdeg"]})",
                           R"({"bytes":1,"xxh64":["0123456789ABCDEF"]})"}) {
    const auto bad = nlohmann::json::parse(text);
    EXPECT_THROW(TensorFileSummary::from_json(JsonReader(bad, "s")), Error) << text;
  }
}

}  // namespace
}  // namespace rimlight
