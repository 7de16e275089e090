#include "core/vertices/view_transport.h"

#include <algorithm>
#include <array>

#include "core/base/check.h"

namespace rimlight {

struct ViewTransport::Workspace {
  AlignedVector<float> visibility, of_lobe;
  LobeProduct::Workspace product;
};

ViewTransport::ViewTransport(const VertexTransportView& transport)
    : products_(transport), product_(transport.visibility_degree) {}

void ViewTransport::prepare_lobes(std::span<const float> factors) {
  const auto degrees = static_cast<std::size_t>(product_.degree()) + 1;
  RIMLIGHT_CHECK_EQ(factors.size() % degrees, std::size_t{0});
  if (std::ranges::equal(factors, factors_)) return;
  factors_.assign(factors.begin(), factors.end());
  lobes_.clear();
  for (std::size_t at = 0; at < factors.size(); at += degrees) {
    lobes_.emplace_back(product_.degree(), factors.subspan(at, degrees));
  }
}

void ViewTransport::set_view(const VertexSelection& selection, const VertexGloss& gloss) {
  products_.check(selection, gloss);
  prepare_lobes(gloss.lobes);
  const VertexTransportView& transport = products_.transport();
  const std::size_t vertices = selection.vertex_count();
  irradiance_.assign({vertices, transport.irradiance_channels, transport.irradiance_degree},
                     [&](std::size_t panel, std::span<float> values) {
                       products_.load_irradiance(selection, panel, values.data());
                     });
  highlights_.assign({vertices, 1, 2 * product_.degree()},
                     [&](std::size_t panel, std::span<float> values) {
                       fill_highlights(selection, gloss, panel, values);
                     });
}

void ViewTransport::fill_highlights(const VertexSelection& selection, const VertexGloss& gloss,
                                    std::size_t panel, std::span<float> values) const {
  thread_local Workspace work;
  const std::size_t size = sh::coefficient_count(product_.degree()) * kBatchVertices;
  if (work.visibility.size() < size) work.visibility.resize(size);
  const auto visibility = std::span(work.visibility).first(size);
  products_.load_visibility(selection, panel, visibility.data());
  std::array<Vec3f, kBatchVertices> axes;
  axes.fill({0, 0, 1});
  std::array<std::size_t, kBatchVertices> lobe_of{};
  selection.for_each_vertex(panel, [&](std::size_t vertex, std::size_t lane) {
    axes[lane] = gloss.mirrored[vertex];
    lobe_of[lane] = gloss.lobe_of.empty() ? 0 : gloss.lobe_of[vertex];
    RIMLIGHT_CHECK(lobe_of[lane] < lobes_.size());
  });
  const std::size_t lanes = selection.lane_count(panel), first = lobe_of[0];
  product_.multiply(lobes_[first], axes, visibility, values, work.product);
  // Panels of several materials are few: one product for each lobe, of which some lanes are taken.
  for (std::size_t lobe = 0; lobe < lobes_.size(); ++lobe) {
    const auto in_panel = std::span(lobe_of).first(lanes);
    if (lobe == first || std::ranges::find(in_panel, lobe) == in_panel.end()) continue;
    if (work.of_lobe.size() < values.size()) work.of_lobe.resize(values.size());
    const auto of_lobe = std::span(work.of_lobe).first(values.size());
    product_.multiply(lobes_[lobe], axes, visibility, of_lobe, work.product);
    for (std::size_t k = 0; k < values.size(); ++k) {
      if (lobe_of[k % kBatchVertices] == lobe) values[k] = of_lobe[k];
    }
  }
}

void ViewTransport::calculate(std::span<const float> light, const Tolerance& tolerance,
                              std::span<float> irradiance, std::span<float> highlights) {
  irradiance_.choose_bands(light, tolerance.irradiance);
  highlights_.choose_bands(light, tolerance.highlight);
  irradiance_.apply(light, irradiance);
  highlights_.apply(light, highlights);
}

}  // namespace rimlight
