#include "core/transport/reference_rows.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/math/random.h"
#include "tests/support/error_of.h"
#include "tests/support/small_bake.h"
#include "tests/support/temporary_folder.h"

namespace rimlight {
namespace {

using ::testing::HasSubstr;

constexpr std::size_t kRowFloats = 3 * PixelLayout::kGroupReceivers;

struct Rows {
  std::vector<std::uint64_t> groups = {0, 128, 4096};
  std::vector<float> values;
};

Rows random_rows(std::size_t columns) {
  Rows rows;
  Random random(5);
  for (std::size_t i = 0; i < rows.groups.size() * columns * kRowFloats; ++i) {
    rows.values.push_back(static_cast<float>(random.uniform(-1, 1)));
  }
  return rows;
}

/// A small bake with these rows.
void write_bake(const std::filesystem::path& folder, const test::SmallBake& settings,
                const Rows& rows, std::size_t columns) {
  BakeWriter writer(folder);
  fill(writer, settings);
  const auto file =
      writer.create(kReferenceFile, reference_tensors({.rows = rows.groups.size()}, columns));
  file->append(std::span<const std::uint64_t>(rows.groups));
  file->append(std::span<const float>(rows.values));
  writer.add_file(kReferenceFile, file->finish());
  writer.commit(small_manifest(settings));
}

class ReferenceRowsTest : public ::testing::Test {
 protected:
  std::string error_of_using(const Rows& rows, std::size_t columns) {
    write_bake(folder_ / "a.bake", settings_, rows, columns);
    const Bake bake(folder_ / "a.bake");
    return test::error_of([&] {
      const auto read = ReferenceRows::open(bake);
      const std::vector<CubeLight> lights = {light(1)};
      read->multiply(lights);
    });
  }

  CubeLight light(std::uint64_t seed) const {
    CubeLight result(settings_.cube_size);
    Random random(seed, 1);
    for (float& value : result.values) value = static_cast<float>(random.uniform(-1, 1));
    return result;
  }

  test::TemporaryFolder folder_;
  test::SmallBake settings_;
  std::size_t columns_ = cube::texel_count(settings_.cube_size);
};

TEST_F(ReferenceRowsTest, GiveTheImageThatTheirSumInDoubleGives) {
  const Rows rows = random_rows(columns_);
  write_bake(folder_ / "a.bake", settings_, rows, columns_);
  const Bake bake(folder_ / "a.bake");
  const auto read = ReferenceRows::open(bake);
  ASSERT_TRUE(read);
  EXPECT_EQ(std::vector<std::uint64_t>(read->groups().begin(), read->groups().end()), rows.groups);
  const std::vector<CubeLight> lights = {light(1), light(2), CubeLight(settings_.cube_size)};
  const auto images = read->multiply(lights);
  ASSERT_EQ(images.size(), lights.size());
  for (std::size_t i = 0; i < images.size(); ++i) {
    ASSERT_EQ(images[i].size(), rows.groups.size() * 64);
    for (std::size_t at = 0; at < images[i].size(); ++at) {
      for (std::size_t c = 0; c < 3; ++c) {
        double expected = 0;
        for (std::size_t j = 0; j < columns_; ++j) {
          const float row = rows.values[((at / 64 * columns_ + j) * 3 + c) * 64 + at % 64];
          expected += static_cast<double>(row) * lights[i].channel(static_cast<int>(c))[j];
        }
        // One rounding to float.
        ASSERT_NEAR(images[i][at][static_cast<int>(c)], expected, 0x1p-23 * std::abs(expected));
      }
    }
  }
}

TEST_F(ReferenceRowsTest, AreNotThereInABakeWithoutThem) {
  test::write_small_bake(folder_ / "plain.bake", settings_);
  EXPECT_FALSE(ReferenceRows::open(Bake(folder_ / "plain.bake")));
}

TEST_F(ReferenceRowsTest, AreRefusedWhereTheyFitNoGroupOfThePicture) {
  for (const std::vector<std::uint64_t>& groups : {std::vector<std::uint64_t>{128, 0, 4096},
                                                   {0, 0, 64},
                                                   {0, 65, 128},
                                                   {0, 64, settings_.pixels.receiver_count()},
                                                   {0, 64, ~std::uint64_t{63}}}) {
    Rows rows = random_rows(columns_);
    rows.groups = groups;
    const std::string error = error_of_using(rows, columns_);
    EXPECT_THAT(error, HasSubstr("reference.safetensors: tensor \"first_receiver\""));
  }
  EXPECT_THAT(error_of_using(random_rows(columns_ / 2), columns_ / 2),
              HasSubstr("tensor \"rows\": found shape"));
}

TEST_F(ReferenceRowsTest, AreRefusedWhereTheyAreNotFinite) {
  for (const float bad : {std::numeric_limits<float>::infinity(), std::nanf("")}) {
    Rows rows = random_rows(columns_);
    rows.values[columns_ * kRowFloats + 7] = bad;
    EXPECT_THAT(error_of_using(rows, columns_), HasSubstr("tensor \"rows\", group 1"));
  }
}

}  // namespace
}  // namespace rimlight
