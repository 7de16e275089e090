#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "core/transport/receivers.h"
#include "core/transport/sketch.h"
#include "core/transport/tensor_file.h"
#include "core/transport/transport.h"

namespace rimlight {

// What a bake's tensor files hold, read and checked: shapes, ranges, everything finite. `path` is
// for errors; they name it and the tensor. docs/formats/bake.md has the tensors.

/// Throws Error unless the tensor has this shape.
void expect_shape(const TensorFile& file, const std::string& path, const std::string& name,
                  const std::vector<std::size_t>& expected);
std::string shape_text(const std::vector<std::size_t>& shape);

/// A view of the file's memory.
TransportView read_transport(const TensorFile& file, const std::string& path,
                             std::size_t tile_count, std::size_t column_count);

/// [height][width], in [0, 1].
std::vector<float> read_coverage(const TensorFile& file, const std::string& path,
                                 const PixelLayout& pixels);
/// Padded receivers have 0.
ReceiverValues read_reflectance(const TensorFile& file, const std::string& path,
                                const PixelLayout& pixels);

std::vector<TensorShape> sketch_tensors(std::size_t column_count);
/// Appends the values of sketch_tensors().
void write_sketch(TensorFileWriter& writer, const Sketch& sketch);
Sketch read_sketch(const TensorFile& file, const std::string& path, std::size_t column_count);

}  // namespace rimlight
