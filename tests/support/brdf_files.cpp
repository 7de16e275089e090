#include "tests/support/brdf_files.h"

#include <sstream>

namespace rimlight::test {
namespace {

template <typename T>
void append(std::string& bytes, T value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof(value));
}

std::size_t count_of(const RglField& field) {
  std::size_t count = 1;
  for (const std::uint64_t size : field.shape) count *= size;
  return count;
}

RglField filled(std::string name, std::vector<std::uint64_t> shape, float value) {
  RglField field{std::move(name), std::move(shape), {}};
  field.values.assign(count_of(field), value);
  return field;
}

}  // namespace

std::string merl_file(const std::function<double(int channel, std::size_t bin)>& stored) {
  constexpr std::size_t kBins = 90 * 90 * 180;
  std::string bytes;
  bytes.reserve(12 + 3 * kBins * sizeof(double));
  for (const std::int32_t size : {90, 90, 180}) append(bytes, size);
  for (int channel = 0; channel < 3; ++channel) {
    for (std::size_t bin = 0; bin < kBins; ++bin) append(bytes, stored(channel, bin));
  }
  return bytes;
}

std::string cornell_file(const std::vector<double>& wavelengths,
                         const std::vector<CornellLine>& lines) {
  std::ostringstream text;
  text.precision(9);
  text << "# num wls\n" << wavelengths.size() << "\n\n# wls\n";
  for (const double wavelength : wavelengths) text << wavelength << ' ';
  text << "\n# theta i, phi i, theta s, phi_s, spectral sample values\n";
  for (const CornellLine& line : lines) {
    for (const double angle : line.angles) text << angle << ' ';
    for (const double value : line.values) text << value << ' ';
    text << '\n';
  }
  return text.str();
}

std::string rgl_file(const std::vector<RglField>& fields) {
  std::size_t offset = 18;
  for (const RglField& field : fields) offset += 13 + field.name.size() + 8 * field.shape.size();
  std::string header("tensor_file\0\1\0", 14), data;
  append(header, static_cast<std::uint32_t>(fields.size()));
  for (const RglField& field : fields) {
    append(header, static_cast<std::uint16_t>(field.name.size()));
    header += field.name;
    append(header, static_cast<std::uint16_t>(field.shape.size()));
    append(header, field.type);
    append(header, static_cast<std::uint64_t>(offset + data.size()));
    for (const std::uint64_t size : field.shape) append(header, size);
    for (const float value : field.values) append(data, value);
  }
  return header + data;
}

std::vector<RglField> small_rgl_fields(float ndf, float sigma, const Vec3f& rgb) {
  RglField colours = filled("rgb", {1, 3, 3, 4, 5}, 0);
  for (std::size_t i = 0; i < colours.values.size(); ++i) {
    colours.values[i] = rgb[static_cast<int>(i / 20 % 3)];
  }
  return {filled("phi_i", {1}, 0),         {"theta_i", {3}, {0, 0.8f, 1.5707964f}},
          filled("sigma", {2, 8}, sigma),  filled("ndf", {2, 8}, ndf),
          filled("vndf", {1, 3, 6, 7}, 1), colours};
}

}  // namespace rimlight::test
