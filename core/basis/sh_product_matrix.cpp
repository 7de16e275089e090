#include "core/basis/sh_product_matrix.h"

#include <algorithm>

#include "core/base/check.h"
#include "core/basis/sh_product_degrees_kernel.h"
#include "core/basis/sh_product_matrix_kernel.h"

namespace rimlight {
namespace {

constexpr std::size_t kLaneMultiple = 16;
constexpr std::size_t kRowMultiple = 16;  // of floats: a cache line

const ShTripling* table_to(int degree) { return &ShTripling::to_degree(degree); }

/// The degree of a light of so many coefficients in all.
int light_degree(std::size_t floats) {
  int degree = 0;
  while (degree <= sh::kLargestLightDegree &&
         floats != ShProductMatrix::kChannels * sh::coefficient_count(degree)) {
    ++degree;
  }
  RIMLIGHT_CHECK(degree <= sh::kLargestLightDegree);
  return degree;
}

/// Coefficients of degrees to `last` into the kernel's order; what is above stays as it is.
void pack_light(std::span<const float> light, int packed_degree, int last,
                AlignedVector<float>& packed) {
  const std::size_t channel = light.size() / ShProductMatrix::kChannels;
  for (int l = 0; l <= last; ++l) {
    for (int m = 0; m <= l; ++m) {
      float* const entry = packed.data() + ShPackedLight::place(packed_degree, l, m);
      for (std::size_t c = 0; c < ShProductMatrix::kChannels; ++c) {
        entry[c] = light[c * channel + sh::index(l, m)];
        if (m > 0) entry[4 + c] = light[c * channel + sh::index(l, -m)];
      }
    }
  }
}

}  // namespace

ShProductMatrix::ShProductMatrix(int degree)
    : degree_(degree), size_(0), stride_(0), table_(table_to(degree)) {
  size_ = sh::coefficient_count(degree);
  stride_ = (size_ + kRowMultiple - 1) / kRowMultiple * kRowMultiple;
  values_.resize(kChannels * size_ * stride_);
  rows_.resize(2 * stride_ * ShMatrixBuild::kPixel);
  packed_.resize(static_cast<std::size_t>((2 * degree + 1) * (degree + 1)) * ShPackedLight::kEntry);
}

void ShProductMatrix::set_light(std::span<const float> light, const ShDegreeRange& degrees) {
  build(light, degrees, Build::from_zero);
}

void ShProductMatrix::add_light(std::span<const float> light, const ShDegreeRange& degrees) {
  build(light, degrees, Build::on_top);
}

void ShProductMatrix::build(std::span<const float> light, const ShDegreeRange& degrees, Build how) {
  RIMLIGHT_CHECK(degrees.first >= 0 && degrees.first <= degrees.last);
  const int last = std::min({degrees.last, light_degree(light.size()), 2 * degree_});
  pack_light(light, 2 * degree_, last, packed_);
  build_product_matrix({table_,
                        {2 * degree_, packed_.data()},
                        degrees.first,
                        last,
                        how == Build::on_top,
                        rows_.data(),
                        values_.data(),
                        stride_});
}

void add_product_degrees(const ShProductMatrix& matrix, const ShDegreeRange& degrees,
                         std::span<const float> transport, std::span<float> product,
                         std::size_t lanes) {
  RIMLIGHT_CHECK(degrees.first >= 0 && degrees.first <= degrees.last);
  RIMLIGHT_CHECK(degrees.last <= matrix.degree());
  RIMLIGHT_CHECK_EQ(lanes % kLaneMultiple, std::size_t{0});
  RIMLIGHT_CHECK_EQ(transport.size(), matrix.size() * lanes);
  RIMLIGHT_CHECK_EQ(product.size(), ShProductMatrix::kChannels * transport.size());
  const std::size_t below = sh::coefficient_count(degrees.first - 1);
  const std::size_t end = sh::coefficient_count(degrees.last);
  for (std::size_t channel = 0; channel < ShProductMatrix::kChannels; ++channel) {
    const ShMatrixProduct whole = {matrix.row(channel, 0), matrix.stride(), transport.data(),
                                   product.data() + channel * transport.size(), lanes};
    add_matrix_product(whole, {0, below}, {below, end});
    add_matrix_product(whole, {below, end}, {0, end});
  }
}

double product_degrees_flops(const ShDegreeRange& degrees) {
  const auto below = static_cast<double>(sh::coefficient_count(degrees.first - 1));
  const auto end = static_cast<double>(sh::coefficient_count(degrees.last));
  return 2.0 * static_cast<double>(ShProductMatrix::kChannels) * (end * end - below * below);
}

}  // namespace rimlight
