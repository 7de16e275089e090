#include "core/vertices/vertex_products.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "core/base/check.h"
#include "core/base/parallel.h"
#include "core/basis/sh_kernel.h"
#include "core/basis/sh_product_degrees_kernel.h"
#include "core/vertices/open_irradiance.h"

namespace rimlight {
namespace {

constexpr std::size_t kSums = kLightChannels * kBatchVertices;

/// Each thread's, so that it is allocated once.
struct PanelWorkspace {
  AlignedVector<float> visibility, lobes, factors;

  static PanelWorkspace& of_thread() {
    thread_local PanelWorkspace workspace;
    return workspace;
  }
};

float* sized(AlignedVector<float>& values, std::size_t size) {
  if (values.size() < size) values.resize(size);
  return values.data();
}

/// parallel_for without the allocation of a large closure.
template <typename Body>
void for_each_index(std::size_t count, const Body& body) {
  parallel_for(count, std::cref(body));
}

/// A panel of transport [batch][rows][kBatchVertices], with zeros in the lanes of padding.
void load_panel(const VertexSelection& selection, std::size_t panel,
                std::span<const Half> transport, std::size_t rows, float* values) {
  selection.for_each_part(panel, [&](std::uint32_t batch, std::uint64_t lanes, std::size_t to) {
    load_lanes({transport.data() + batch * rows * kBatchVertices, lanes, to}, rows, values);
  });
  const std::size_t used = selection.lane_count(panel);
  for (std::size_t i = 0; i < rows && used < kBatchVertices; ++i) {
    std::fill(values + i * kBatchVertices + used, values + (i + 1) * kBatchVertices, 0.0f);
  }
}

}  // namespace

std::vector<float> convolution_factors(std::span<const double> lobe) {
  std::vector<float> factors(lobe.size());
  for (std::size_t l = 0; l < lobe.size(); ++l) {
    const double norm = std::sqrt(4 * std::numbers::pi / (2 * static_cast<double>(l) + 1));
    factors[l] = static_cast<float>(norm * lobe[l]);
  }
  return factors;
}

VertexProducts::VertexProducts(const VertexTransportView& transport)
    : transport_(transport), matrix_(transport.visibility_degree) {
  RIMLIGHT_CHECK(transport.highlight_count <= transport.vertex_count);
  RIMLIGHT_CHECK(transport.irradiance_channels <= 1 ||
                 transport.irradiance_channels == kLightChannels);
  if (transport.irradiance_channels == 0) {
    RIMLIGHT_CHECK_EQ(transport.normals.size(), transport.vertex_count);
  }
  sh::check_degree(transport.irradiance_degree);
  const std::size_t count = sh::coefficient_count(transport.irradiance_degree);
  RIMLIGHT_CHECK_EQ(
      transport.irradiance.size(),
      batch_count(transport.vertex_count) * transport.irradiance_channels * count * kBatchVertices);
  RIMLIGHT_CHECK_EQ(transport.visibility.size(),
                    batch_count(transport.highlight_count) * matrix_.size() * kBatchVertices);
  light_.resize(kLightChannels * count);
}

void VertexProducts::set_light(std::span<const float> light) {
  matrix_.set_light(light);
  const std::size_t given = light.size() / kLightChannels;
  const std::size_t count = light_.size() / kLightChannels;
  std::ranges::fill(light_, 0.0f);
  for (std::size_t c = 0; c < kLightChannels; ++c) {
    const std::span<const float> channel = light.subspan(c * given, std::min(count, given));
    std::ranges::copy(channel, light_.begin() + static_cast<std::ptrdiff_t>(c * count));
  }
}

void VertexProducts::check(const VertexSelection& selection, std::size_t vertices) const {
  RIMLIGHT_CHECK(selection.batch_end() <= batch_count(vertices));
}

void VertexProducts::check(const VertexSelection& selection, const VertexGloss& gloss) const {
  check(selection, transport_.highlight_count);
  RIMLIGHT_CHECK(selection.vertex_end() <= gloss.mirrored.size());
  RIMLIGHT_CHECK(gloss.lobe_of.empty() || selection.vertex_end() <= gloss.lobe_of.size());
}

void VertexProducts::irradiance(const VertexSelection& selection, std::span<float> to) const {
  check(selection, transport_.vertex_count);
  RIMLIGHT_CHECK_EQ(to.size(), selection.panel_count() * kSums);
  if (transport_.irradiance_channels == 0) {
    open_irradiance(selection, transport_.normals, light_, transport_.irradiance_degree, to);
    return;
  }
  const std::size_t count = light_.size() / kLightChannels;
  const std::size_t batch = transport_.irradiance_channels * count * kBatchVertices;
  // By pieces: a batch whose vertices go to two panels is summed once.
  constexpr std::size_t kPieces = 16;
  const auto& pieces = selection.pieces();
  for_each_index((pieces.size() + kPieces - 1) / kPieces, [&](std::size_t chunk) {
    alignas(64) std::array<float, kSums> sums;
    const std::size_t end = std::min(pieces.size(), (chunk + 1) * kPieces);
    for (std::size_t p = chunk * kPieces; p < end; ++p) {
      sum_batch({transport_.irradiance.data() + pieces[p].batch * batch,
                 transport_.irradiance_channels, count, light_.data(), count, count},
                sums.data());
      std::size_t packed = pieces[p].first;
      for (std::uint64_t lanes = pieces[p].lanes; lanes != 0; lanes &= lanes - 1, ++packed) {
        const auto lane = static_cast<std::size_t>(std::countr_zero(lanes));
        float* const place = to.data() + packed / kBatchVertices * kSums + packed % kBatchVertices;
        for (std::size_t c = 0; c < kLightChannels; ++c) {
          place[c * kBatchVertices] = sums[c * kBatchVertices + lane];
        }
      }
    }
  });
  for (std::size_t lane = selection.vertex_count(); lane % kBatchVertices != 0; ++lane) {
    float* const place = to.data() + lane / kBatchVertices * kSums + lane % kBatchVertices;
    for (std::size_t c = 0; c < kLightChannels; ++c) place[c * kBatchVertices] = 0;
  }
}

void VertexProducts::load_irradiance(const VertexSelection& selection, std::size_t panel,
                                     float* values) const {
  RIMLIGHT_CHECK(transport_.irradiance_channels > 0);
  load_panel(selection, panel, transport_.irradiance,
             transport_.irradiance_channels * sh::coefficient_count(transport_.irradiance_degree),
             values);
}

void VertexProducts::load_visibility(const VertexSelection& selection, std::size_t panel,
                                     float* values) const {
  load_panel(selection, panel, transport_.visibility, matrix_.size(), values);
}

void VertexProducts::load_lobes(const VertexSelection& selection, std::size_t panel,
                                const VertexGloss& gloss, float* values) const {
  alignas(64) std::array<float, kBatchVertices> x{}, y{}, z;
  z.fill(1);
  const auto degrees = static_cast<std::size_t>(matrix_.degree()) + 1;
  float* const factors = sized(PanelWorkspace::of_thread().factors, degrees * kBatchVertices);
  std::fill_n(factors, degrees * kBatchVertices, 0.0f);
  selection.for_each_vertex(panel, [&](std::size_t vertex, std::size_t lane) {
    const Vec3f& mirrored = gloss.mirrored[vertex];
    x[lane] = mirrored.x;
    y[lane] = mirrored.y;
    z[lane] = mirrored.z;
    const std::size_t lobe = gloss.lobe_of.empty() ? 0 : gloss.lobe_of[vertex];
    RIMLIGHT_CHECK((lobe + 1) * degrees <= gloss.lobes.size());
    for (std::size_t l = 0; l < degrees; ++l) {
      factors[l * kBatchVertices + lane] = gloss.lobes[lobe * degrees + l];
    }
  });
  sh::evaluate({x, y, z}, matrix_.degree(), {values, matrix_.size() * kBatchVertices},
               kBatchVertices);
  std::size_t i = 0;
  for (std::size_t l = 0; l < degrees; ++l) {
    for (; i < (l + 1) * (l + 1); ++i) {
      float* const row = values + i * kBatchVertices;
      for (std::size_t lane = 0; lane < kBatchVertices; ++lane) {
        row[lane] *= factors[l * kBatchVertices + lane];
      }
    }
  }
}

ChannelMatrices VertexProducts::matrices() const {
  return {{matrix_.row(0, 0), matrix_.row(1, 0), matrix_.row(2, 0)}, matrix_.stride()};
}

void VertexProducts::incident_by_vertex(const VertexSelection& selection,
                                        std::span<float> to) const {
  check(selection, transport_.highlight_count);
  const std::size_t stride = row_stride(), vertex_size = kLightChannels * stride;
  RIMLIGHT_CHECK(selection.vertex_end() * vertex_size <= to.size());
  for_each_index(selection.panel_count(), [&](std::size_t panel) {
    float* const visibility =
        sized(PanelWorkspace::of_thread().visibility, matrix_.size() * kBatchVertices);
    load_visibility(selection, panel, visibility);
    for (std::size_t c = 0; c < kLightChannels; ++c) {
      std::array<float*, kBatchVertices> rows{};
      selection.for_each_vertex(panel, [&](std::size_t vertex, std::size_t lane) {
        rows[lane] = to.data() + vertex * vertex_size + c * stride;
      });
      multiply_to_rows({matrix_.row(c, 0), matrix_.size(), stride, visibility},
                       std::span(rows).first(selection.lane_count(panel)));
    }
  });
}

void VertexProducts::highlights(const VertexSelection& selection, const VertexGloss& gloss,
                                std::span<float> to) const {
  check(selection, gloss);
  RIMLIGHT_CHECK_EQ(to.size(), selection.panel_count() * kSums);
  for_each_index(selection.panel_count(), [&](std::size_t panel) {
    PanelWorkspace& work = PanelWorkspace::of_thread();
    float* const visibility = sized(work.visibility, matrix_.size() * kBatchVertices);
    float* const lobes = sized(work.lobes, matrix_.size() * kBatchVertices);
    load_visibility(selection, panel, visibility);
    load_lobes(selection, panel, gloss, lobes);
    float* const sums = to.data() + panel * kSums;
    std::fill_n(sums, kSums, 0.0f);
    const CoefficientRange all = {0, matrix_.size()};
    add_bilinear_form(matrices(), {all, all, lobes, visibility, selection.lane_count(panel)}, sums);
  });
}

double VertexProducts::highlight_flops() const {
  return product_degrees_flops({0, matrix_.degree()});
}

}  // namespace rimlight
