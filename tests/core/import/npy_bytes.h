#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace rimlight {

/// A .npy file's bytes, as numpy.save lays them out: magic, version, padded header, data.
inline std::string npy_bytes(const std::string& header, const std::string& data, int version = 1) {
  std::string bytes = "\x93NUMPY";
  bytes += static_cast<char>(version);
  bytes += '\0';
  const std::size_t before = version == 1 ? 10 : 12;
  std::string text = header;
  while ((before + text.size() + 1) % 64 != 0) text += ' ';
  text += '\n';
  for (std::size_t i = 0; i < before - 8; ++i) {
    bytes += static_cast<char>(text.size() >> (8 * i) & 0xff);
  }
  return bytes + text + data;
}

inline std::string npy_header(const std::string& type, const std::vector<std::size_t>& shape) {
  std::string sides;
  for (const std::size_t side : shape) sides += std::to_string(side) + ", ";
  return "{'descr': '" + type + "', 'fortran_order': False, 'shape': (" + sides + "), }";
}

template <typename T>
std::string bytes_of(std::span<const T> values) {
  return {reinterpret_cast<const char*>(values.data()), values.size_bytes()};
}

inline std::string npy_floats(const std::vector<std::size_t>& shape,
                              const std::vector<float>& values) {
  return npy_bytes(npy_header("<f4", shape), bytes_of(std::span<const float>(values)));
}

}  // namespace rimlight
