#include "core/transport/bake_tensors.h"

#include <algorithm>
#include <limits>

#include "core/base/error.h"

namespace rimlight {
namespace {

/// Throws Error at the first value of a tensor that is negative or not finite.
void expect_sizes(std::span<const float> values, const std::string& path, const std::string& name) {
  const auto bad = std::ranges::find_if_not(
      values, [](float value) { return value >= 0 && value <= std::numeric_limits<float>::max(); });
  if (bad == values.end()) return;
  throw Error(
      path + ": tensor " + quote(name) + ", element " + std::to_string(bad - values.begin()),
      std::to_string(*bad), "a finite number, 0 or more");
}

std::size_t side(int pixels) { return static_cast<std::size_t>(pixels); }

}  // namespace

std::string shape_text(const std::vector<std::size_t>& shape) {
  std::string text = "[";
  for (const std::size_t length : shape) {
    text += (text.size() > 1 ? ", " : "") + std::to_string(length);
  }
  return text + "]";
}

void expect_shape(const TensorFile& file, const std::string& path, const std::string& name,
                  const std::vector<std::size_t>& expected) {
  const auto& found = file.shape(name);
  if (found == expected) return;
  throw Error(path + ": tensor " + quote(name), "shape " + shape_text(found),
              "shape " + shape_text(expected));
}

TransportView read_transport(const TensorFile& file, const std::string& path,
                             std::size_t tile_count, std::size_t column_count) {
  expect_shape(file, path, "column_step", {column_count});
  expect_shape(file, path, "tile_first_word", {tile_count + 1});
  expect_shape(file, path, "run_offset", {tile_count, column_count + 1});
  const auto runs = file.tensor<std::uint64_t>("runs", ElementType::u64);
  expect_shape(file, path, "runs", {runs.size()});
  return {{.tile_count = tile_count,
           .column_count = column_count,
           .column_step = file.tensor<float>("column_step", ElementType::f32),
           .tile_first_word = file.tensor<std::uint64_t>("tile_first_word", ElementType::u64),
           .run_offset = file.tensor<std::uint32_t>("run_offset", ElementType::u32),
           .runs = runs},
          path};
}

std::vector<float> read_coverage(const TensorFile& file, const std::string& path,
                                 const PixelLayout& pixels) {
  expect_shape(file, path, "coverage", {side(pixels.height), side(pixels.width)});
  std::vector<float> coverage;
  for (const std::uint8_t share : file.tensor<std::uint8_t>("coverage", ElementType::u8)) {
    coverage.push_back(static_cast<float>(share) / 255);
  }
  return coverage;
}

ReceiverValues read_reflectance(const TensorFile& file, const std::string& path,
                                const PixelLayout& pixels) {
  expect_shape(file, path, "reflectance", {side(pixels.height), side(pixels.width), 3});
  const auto values = file.tensor<float>("reflectance", ElementType::f32);
  expect_sizes(values, path, "reflectance");
  ReceiverValues reflectance(pixels.tile_count());
  const float* next = values.data();
  for (int y = 0; y < pixels.height; ++y) {
    for (int x = 0; x < pixels.width; ++x, next += 3) {
      reflectance.set(pixels.receiver(x, y), {next[0], next[1], next[2]});
    }
  }
  return reflectance;
}

std::vector<TensorShape> sketch_tensors(std::size_t column_count) {
  return {{"stored", ElementType::u8, {3, column_count, kLayers, kSketchRows}},
          {"error", ElementType::u8, {3, column_count, kSketchRows}},
          {"stored_scale", ElementType::f32, {3, column_count, kLayers}},
          {"error_scale", ElementType::f32, {3, column_count}},
          {"norm_squared", ElementType::f32, {3, column_count}},
          {"part_norm_squared", ElementType::f32, {3, column_count, kLayers}}};
}

void write_sketch(TensorFileWriter& writer, const Sketch& sketch) {
  for (const auto* bytes : {&sketch.stored, &sketch.error}) {
    writer.append(std::span<const std::int8_t>(*bytes));
  }
  for (const auto* values : {&sketch.stored_scale, &sketch.error_scale, &sketch.norm_squared,
                             &sketch.part_norm_squared}) {
    writer.append(std::span<const float>(*values));
  }
}

Sketch read_sketch(const TensorFile& file, const std::string& path, std::size_t column_count) {
  for (const TensorShape& tensor : sketch_tensors(column_count)) {
    expect_shape(file, path, tensor.name, tensor.shape);
  }
  const auto copy = [](const auto& from, auto& to) { to.assign(from.begin(), from.end()); };
  Sketch sketch;
  sketch.column_count = column_count;
  copy(file.tensor<std::int8_t>("stored", ElementType::u8), sketch.stored);
  copy(file.tensor<std::int8_t>("error", ElementType::u8), sketch.error);
  copy(file.tensor<float>("stored_scale", ElementType::f32), sketch.stored_scale);
  copy(file.tensor<float>("error_scale", ElementType::f32), sketch.error_scale);
  copy(file.tensor<float>("norm_squared", ElementType::f32), sketch.norm_squared);
  expect_sizes(sketch.stored_scale, path, "stored_scale");
  expect_sizes(sketch.error_scale, path, "error_scale");
  copy(file.tensor<float>("part_norm_squared", ElementType::f32), sketch.part_norm_squared);
  expect_sizes(sketch.norm_squared, path, "norm_squared");
  expect_sizes(sketch.part_norm_squared, path, "part_norm_squared");
  return sketch;
}

}  // namespace rimlight
