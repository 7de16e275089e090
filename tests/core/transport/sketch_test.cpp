#include "core/transport/sketch.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <thread>
#include <vector>

#include "core/math/random.h"
#include "core/transport/tile_builder.h"
#include "tests/support/random_transport.h"
#include "tests/support/reference/columns.h"
#include "tests/support/reference/pixel_haar.h"

namespace rimlight {
namespace {

constexpr std::size_t kTiles = 3;
constexpr std::size_t kColumns = 20;
constexpr std::size_t kReceivers = kTiles * kTileReceivers;
using Image = std::vector<double>;  // [channel][receiver]

const TransportView& transport() {
  static const Transport made =
      test::random_transport({.tile_count = kTiles, .column_count = kColumns, .density = 0.3});
  return made.view();
}

const ReceiverValues& reflectance() {
  static const ReceiverValues made = [] {
    ReceiverValues values(kTiles);
    Random random(17);
    for (std::size_t i = 0; i < kReceivers; ++i) {
      const auto value = [&] { return static_cast<float>(random.uniform(0.1, 2)); };
      values.set(i, {value(), value(), value()});
    }
    return values;
  }();
  return made;
}

/// A column of M̂, or some layers of it, as radiance, in double.
Image column_image(std::size_t column, LayerSet layers = kAllLayers) {
  Image image(3 * kReceivers);
  const std::vector<float> zero(kTileFloats);
  const std::vector<ColumnDelta> delta = {{static_cast<std::uint32_t>(column), {1, 1, 1}, layers}};
  for (std::size_t tile = 0; tile < kTiles; ++tile) {
    const auto held = reference::add_columns(transport(), tile, delta, zero);
    const auto radiance =
        reference::restore_radiance(held.value, reflectance().tile_span(tile), false);
    for (std::size_t i = 0; i < kTileReceivers; ++i) {
      for (std::size_t c = 0; c < 3; ++c) {
        image[c * kReceivers + tile * kTileReceivers + i] =
            radiance[i / 8 * kBlockFloats + c * 8 + i % 8];
      }
    }
  }
  return image;
}

const std::vector<Image>& columns() {
  static const std::vector<Image> made = [] {
    std::vector<Image> images;
    for (std::size_t j = 0; j < kColumns; ++j) images.push_back(column_image(j));
    return images;
  }();
  return made;
}

/// [part], the layers of M̂ by themselves.
const std::vector<Image>& layers() {
  static const std::vector<Image> made = [] {
    std::vector<Image> images;
    for (std::size_t j = 0; j < kColumns; ++j) {
      for (std::size_t layer = 0; layer < kLayers; ++layer) {
        images.push_back(column_image(j, static_cast<LayerSet>(1 << layer)));
      }
    }
    return images;
  }();
  return made;
}

/// M = M̂ and a little more: compression's error.
const std::vector<Image>& whole_columns() {
  static const std::vector<Image> made = [] {
    std::vector<Image> images = columns();
    Random random(4);
    for (Image& image : images) {
      for (double& value : image) value += 3e-3 * random.uniform(-1, 1);
    }
    return images;
  }();
  return made;
}

std::vector<float> group_rows(std::size_t first_receiver) {
  std::vector<float> rows;
  for (const Image& image : whole_columns()) {
    for (std::size_t c = 0; c < 3; ++c) {
      for (std::size_t i = 0; i < 64; ++i) {
        rows.push_back(static_cast<float>(image[c * kReceivers + first_receiver + i]));
      }
    }
  }
  return rows;
}

void add_groups(SketchSums& sums, std::size_t first, std::size_t stride) {
  for (std::size_t group = first; group < kReceivers / 64; group += stride) {
    sums.add_group(group * 64, group_rows(group * 64));
  }
}

const Sketch& sketch() {
  static const Sketch made = [] {
    SketchSums sums(kColumns, 1e-6f);
    add_groups(sums, 0, 1);
    return make_sketch(sums, transport(), reflectance());
  }();
  return made;
}

TEST(Sketch, SignsAndRowsAreFair) {
  double sum = 0, with_next = 0, across = 0;
  for (std::size_t r = 0; r < kReceivers; ++r) {
    sum += sketch_sign(r, 0);
    with_next += sketch_sign(r, 0) * sketch_sign(r + 1, 0);
    across += sketch_sign(r, 0) * sketch_sign(r, 1);
    ASSERT_EQ(std::abs(sketch_sign(r, 2)), 1);
  }
  const double bound = 4 * std::sqrt(static_cast<double>(kReceivers));
  EXPECT_LE(std::abs(sum), bound);
  EXPECT_LE(std::abs(with_next), bound);
  EXPECT_LE(std::abs(across), bound);
  std::array<int, 3> rows{};
  for (std::size_t group = 0; group < 3000; ++group) ++rows.at(sketch_first_row(group) / 64);
  for (const int count : rows) EXPECT_NEAR(count, 1000, 120);
}

/// The sketch of one channel of an image, in double.
std::array<double, kSketchRows> sketch_of(const Image& image, std::size_t channel) {
  std::array<double, kSketchRows> rows{};
  for (std::size_t r = 0; r < kReceivers; ++r) {
    rows.at(sketch_first_row(r / 64) + r % 64) +=
        static_cast<double>(sketch_sign(r, channel)) * image[channel * kReceivers + r];
  }
  return rows;
}

double square_of(const Image& image, std::size_t channel) {
  double square = 0;
  for (std::size_t r = 0; r < kReceivers; ++r) {
    square += image[channel * kReceivers + r] * image[channel * kReceivers + r];
  }
  return square;
}

/// Rows in 8 bits and a scale, to half a step and `more`.
void expect_rows(const std::int8_t* bytes, float scale, const std::array<double, kSketchRows>& rows,
                 double more) {
  for (std::size_t k = 0; k < kSketchRows; ++k) {
    ASSERT_NEAR(bytes[k] * static_cast<double>(scale), rows.at(k),
                0.501 * static_cast<double>(scale) + more);
  }
}

TEST(Sketch, IsTheSumWithSignsOfEachRowsReceivers) {
  constexpr double kOfUnits = 1e-6 * 64;  // of the sums: 64 groups of each row, 0.3 units each
  for (const std::size_t column : {0u, 7u, 19u}) {
    Image difference = whole_columns()[column];
    for (std::size_t i = 0; i < difference.size(); ++i) difference[i] -= columns()[column][i];
    for (std::size_t c = 0; c < 3; ++c) {
      const std::size_t at = c * kColumns + column;
      expect_rows(sketch().error.data() + at * kSketchRows, sketch().error_scale[at],
                  sketch_of(difference, c), kOfUnits);
      const double square = square_of(columns()[column], c);
      ASSERT_NEAR(sketch().norm_squared[at], square, 1e-4 * square);
    }
  }
}

TEST(Sketch, HoldsEachLayerByItself) {
  for (const std::size_t column : {0u, 7u, 19u}) {
    for (std::size_t layer = 0; layer < kLayers; ++layer) {
      const Image image = column_image(column, static_cast<LayerSet>(1 << layer));
      for (std::size_t c = 0; c < 3; ++c) {
        const std::size_t at = c * kColumns * kLayers + part_of(column, layer);
        expect_rows(sketch().stored.data() + at * kSketchRows, sketch().stored_scale[at],
                    sketch_of(image, c), 1e-9);
        const double square = square_of(image, c);
        ASSERT_GT(square, 0) << "a layer without blocks tells nothing";
        ASSERT_NEAR(sketch().part_norm_squared[at], square, 1e-4 * square);
      }
    }
  }
}

TEST(Sketch, SumsDoNotDependOnTheOrderOrTheThreads) {
  SketchSums once(kColumns, 1e-6f), threads(kColumns, 1e-6f);
  add_groups(once, 0, 1);
  std::vector<std::thread> workers;
  for (std::size_t t = 0; t < 3; ++t)
    workers.emplace_back([&, t] { add_groups(threads, 2 - t, 3); });
  for (std::thread& worker : workers) worker.join();
  EXPECT_TRUE(std::ranges::equal(once.sums(), threads.sums()));
  EXPECT_TRUE(std::ranges::any_of(once.sums(), [](std::int32_t sum) { return sum != 0; }));
}

/// Over many lights the estimate has to be right in the mean and within its standard deviation.
TEST(Sketch, EstimatesTheErrorOfImages) {
  Random random(31);
  double ratio_sum = 0, residual_sum = 0;
  constexpr int kLights = 40;
  int within = 0;
  for (int light = 0; light < kLights; ++light) {
    std::vector<float> target(kColumns), residual(kColumns * kLayers);
    const double share = light % 3 == 0 ? 0 : std::pow(10.0, random.uniform(-4, 0));
    for (float& value : target) value = static_cast<float>(random.uniform(-1, 1));
    for (float& value : residual) value = static_cast<float>(share * random.uniform(-1, 1));
    const std::size_t c = static_cast<std::size_t>(light) % 3;
    Image error(kReceivers), of_time(kReceivers);
    for (std::size_t j = 0; j < kColumns; ++j) {
      for (std::size_t r = 0; r < kReceivers; ++r) {
        const std::size_t at = c * kReceivers + r;
        error[r] += (whole_columns()[j][at] - columns()[j][at]) * static_cast<double>(target[j]);
        for (std::size_t layer = 0; layer < kLayers; ++layer) {
          const double lacks =
              layers()[part_of(j, layer)][at] * static_cast<double>(residual[part_of(j, layer)]);
          error[r] += lacks;
          of_time[r] += lacks;
        }
      }
    }
    const auto norm = [](const Image& image) {
      double square = 0;
      for (const double value : image) square += value * value;
      return std::sqrt(square);
    };
    SketchedImages found = sketch_images(sketch(), c, residual, target, 0, 7);
    found += sketch_images(sketch(), c, residual, target, 7, kColumns - 7);
    const double ratio = std::sqrt(found.error_squared()) / norm(error);
    ratio_sum += ratio;
    within += std::abs(ratio - 1) <= 0.15;
    residual_sum += share > 0 ? std::sqrt(found.residual_squared()) / norm(of_time) : 1;
    if (share == 0) {
      ASSERT_EQ(found.residual_squared(), 0);
    }
  }
  EXPECT_NEAR(ratio_sum / kLights, 1, 0.03);
  EXPECT_NEAR(residual_sum / kLights, 1, 0.03);
  EXPECT_GE(within, 38);  // 95 %
}

}  // namespace
}  // namespace rimlight
