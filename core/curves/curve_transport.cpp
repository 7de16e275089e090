#include "core/curves/curve_transport.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/base/check.h"
#include "core/curves/lobe_tables.h"
#include "core/curves/surface_light.h"

namespace rimlight {
namespace {

constexpr std::size_t kPanelNumbers = kCurveBins * kPanelFloats;
constexpr std::size_t kPanelSteps = kCurveBins * 3;
constexpr float kLargestNumber = 32767;
/// What is smaller is black: its step would be no normal number.
constexpr float kSmallestNumber = 1e-30f;

/// Whole multiples of a step, for each coefficient and channel.
void quantize(std::span<const float> values, std::int16_t* numbers, float* steps) {
  for (std::size_t i = 0; i < kPanelSteps; ++i) {
    const auto rows = values.subspan(i * kPanelRows, kPanelRows);
    float largest = 0;
    for (const float value : rows) largest = std::max(largest, std::abs(value));
    RIMLIGHT_CHECK(std::isfinite(largest));
    const bool is_black = !(largest > kSmallestNumber);
    steps[i] = is_black ? 0 : largest / kLargestNumber;
    const float scale = is_black ? 0 : kLargestNumber / largest;
    for (std::size_t row = 0; row < kPanelRows; ++row) {
      numbers[i * kPanelRows + row] = static_cast<std::int16_t>(std::lrint(rows[row] * scale));
    }
  }
}

/// Where one panel's T′ grows, by bins.
struct PanelBins {
  alignas(64) std::array<float, kBinFloats> row{};
  AlignedVector<float> bins{AlignedVector<float>(kPanelNumbers)};          // [bin][3][row]
  AlignedVector<float> coefficients{AlignedVector<float>(kPanelNumbers)};  // [k][3][row]

  void keep_row(std::size_t index) {
    for (std::size_t i = 0; i < 4 * kCurveBins; ++i) {
      if (i % 4 == 3) continue;
      bins[(i / 4 * 3 + i % 4) * kPanelRows + index] = row[i] + row[i + 4 * kCurveBins];
    }
    row.fill(0);
  }
};

}  // namespace

CurveTransport::CurveTransport(const CurveReceivers& receivers)
    : receivers_(receivers),
      panels_(make_panels(receivers)),
      fixed_(panels_.size() * kPanelFloats),
      fixed_version_(panels_.size()) {
  RIMLIGHT_CHECK_EQ(receivers.visibility.surface_count(), receivers.surfaces.size());
  for (Axis& axis : axes_) {
    axis.version = std::vector<std::atomic<std::uint64_t>>(panels_.size());
    axis.gram.resize(material_count());
  }
}

std::vector<std::uint32_t> CurveTransport::all_panels() const {
  std::vector<std::uint32_t> all(panels_.size());
  std::iota(all.begin(), all.end(), 0u);
  return all;
}

void CurveTransport::set_fixed(std::size_t panel, std::size_t row, const Vec3f& value) {
  for (std::size_t c = 0; c < 3; ++c) {
    fixed_[panel * kPanelFloats + c * kPanelRows + row] = value[static_cast<int>(c)];
  }
}

void CurveTransport::rebuild(std::size_t panel, const CurveLight& light,
                             const CurveMaterialState& state, CurveAxis axis,
                             std::uint64_t version) {
  RIMLIGHT_CHECK(state.has(axis));
  RIMLIGHT_CHECK_EQ(light.sky().cube_size(), receivers_.visibility.cube_size);
  Axis& made = axes_[index(axis)];
  std::call_once(made.allocated, [&] {
    made.numbers.resize(panels_.size() * kPanelNumbers);
    made.steps.resize(panels_.size() * kPanelSteps);
  });
  const LobeTables tables = make_tables(state, axis);
  PanelBins bins;
  for (std::size_t row = 0; row < panels_[panel].row_count; ++row) {
    set_fixed(panel, row,
              sum_row(receivers_, panels_[panel], row, light, state, tables, bins.row.data()));
    bins.keep_row(row);
  }
  made.basis.transform(bins.bins, bins.coefficients, kPanelFloats);
  quantize(bins.coefficients, made.numbers.data() + panel * kPanelNumbers,
           made.steps.data() + panel * kPanelSteps);
  made.version[panel] = version;
  fixed_version_[panel] = version;
}

void CurveTransport::rebuild_fixed(std::size_t panel, const CurveLight& light,
                                   const CurveMaterialState& state, std::uint64_t version) {
  RIMLIGHT_CHECK_EQ(light.sky().cube_size(), receivers_.visibility.cube_size);
  const LobeTables tables = make_fixed_tables(state);
  for (std::size_t row = 0; row < panels_[panel].row_count; ++row) {
    set_fixed(panel, row, sum_row(receivers_, panels_[panel], row, light, state, tables, nullptr));
  }
  fixed_version_[panel] = version;
}

std::uint64_t CurveTransport::fresh_for(std::size_t panel, CurveAxis axis) const {
  return axes_[index(axis)].version[panel];
}

std::uint64_t CurveTransport::fixed_fresh_for(std::size_t panel) const {
  return fixed_version_[panel];
}

std::span<const std::int16_t> CurveTransport::numbers(std::size_t panel, CurveAxis axis) const {
  const auto& numbers = axes_[index(axis)].numbers;
  if (numbers.empty()) return {};
  return std::span(numbers).subspan(panel * kPanelNumbers, kPanelNumbers);
}

std::span<const float> CurveTransport::steps(std::size_t panel, CurveAxis axis) const {
  const auto& steps = axes_[index(axis)].steps;
  if (steps.empty()) return {};
  return std::span(steps).subspan(panel * kPanelSteps, kPanelSteps);
}

std::span<const float> CurveTransport::fixed(std::size_t panel) const {
  return std::span(fixed_).subspan(panel * kPanelFloats, kPanelFloats);
}

}  // namespace rimlight
