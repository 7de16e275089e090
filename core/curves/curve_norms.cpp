#include <algorithm>

#include "core/base/check.h"
#include "core/base/parallel.h"
#include "core/curves/curve_transport.h"
#include "core/curves/gram_kernel.h"

namespace rimlight {
namespace {

constexpr std::size_t kGram = kCurveBins * kCurveBins;
/// Sums of so many panels are in float, sums of those in double.
constexpr std::size_t kFloatPanels = 8;
/// A fixed number of parts, so that any number of threads adds up alike.
constexpr std::size_t kParts = 4;

/// One channel of a panel's T̂, [row][coefficient].
void read_channel(const CurveTransport& transport, std::size_t panel, CurveAxis axis,
                  std::size_t channel, AlignedVector<float>& values) {
  const auto numbers = transport.numbers(panel, axis);
  const auto steps = transport.steps(panel, axis);
  for (std::size_t k = 0; k < kCurveBins; ++k) {
    const float step = steps[k * 3 + channel];
    const std::int16_t* const from = numbers.data() + (k * 3 + channel) * kPanelRows;
    for (std::size_t row = 0; row < kPanelRows; ++row) {
      values[row * kCurveBins + k] = step * static_cast<float>(from[row]);
    }
  }
}

std::vector<double> gram_of(const CurveTransport& transport, std::span<const std::size_t> panels,
                            CurveAxis axis, std::size_t channel) {
  std::vector<double> gram(kGram);
  AlignedVector<float> sums(kGram), values(kPanelRows * kCurveBins);
  for (std::size_t first = 0; first < panels.size(); first += kFloatPanels) {
    std::ranges::fill(sums, 0.0f);
    for (const auto panel : panels.subspan(first, std::min(kFloatPanels, panels.size() - first))) {
      read_channel(transport, panel, axis, channel, values);
      add_gram(values.data(), sums.data());
    }
    for (std::size_t i = 0; i < kGram; ++i) gram[i] += static_cast<double>(sums[i]);
  }
  return gram;
}

}  // namespace

void CurveTransport::find_norms(std::uint32_t material, CurveAxis axis) {
  RIMLIGHT_CHECK(material < material_count());
  Axis& made = axes_[index(axis)];
  RIMLIGHT_CHECK(!made.numbers.empty());
  std::vector<std::size_t> panels;
  for (std::size_t panel = 0; panel < panels_.size(); ++panel) {
    if (panels_[panel].material == material) panels.push_back(panel);
  }
  std::array<std::vector<double>, 3 * kParts> parts;
  parallel_for(parts.size(), [&](std::size_t i) {
    const std::size_t begin = panels.size() * (i % kParts) / kParts;
    const std::size_t end = panels.size() * (i % kParts + 1) / kParts;
    parts[i] = gram_of(*this, std::span(panels).subspan(begin, end - begin), axis, i / kParts);
  });
  std::vector<double> gram;
  for (std::size_t channel = 0; channel < 3; ++channel) {
    std::vector<double>& sum = parts[channel * kParts];
    for (std::size_t part = 1; part < kParts; ++part) {
      const std::vector<double>& other = parts[channel * kParts + part];
      for (std::size_t i = 0; i < kGram; ++i) sum[i] += other[i];
    }
    gram.insert(gram.end(), sum.begin(), sum.end());
  }
  made.gram[material] = std::move(gram);
}

Vec3d CurveTransport::column_norm_squared(std::uint32_t material, CurveAxis axis,
                                          std::size_t coefficient) const {
  const std::vector<double>& gram = axes_[index(axis)].gram[material];
  if (gram.empty()) return {};
  const std::size_t place = coefficient * kCurveBins + coefficient;
  return {gram[place], gram[kGram + place], gram[2 * kGram + place]};
}

double CurveTransport::squared_norm(std::uint32_t material, CurveAxis axis,
                                    const CurveCoefficients& d) const {
  const std::vector<double>& gram = axes_[index(axis)].gram[material];
  if (gram.empty()) return 0;
  double total = 0;
  for (int c = 0; c < 3; ++c) {
    const double* const channel = gram.data() + static_cast<std::size_t>(c) * kGram;
    double sum = 0;
    for (std::size_t k = 0; k < kCurveBins; ++k) {
      const double value = d[k][c];
      if (value == 0) continue;
      double others = 0;
      for (std::size_t j = k + 1; j < kCurveBins; ++j) {
        others += channel[k * kCurveBins + j] * static_cast<double>(d[j][c]);
      }
      sum += value * (channel[k * kCurveBins + k] * value + 2 * others);
    }
    total += std::max(0.0, sum);
  }
  return total;
}

}  // namespace rimlight
