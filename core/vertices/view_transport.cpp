#include "core/vertices/view_transport.h"

#include <algorithm>

#include "core/base/check.h"

namespace rimlight {
namespace {

struct Workspace {
  AlignedVector<float> visibility, lobes;
  ShProduct::Workspace product;
};

}  // namespace

ViewTransport::ViewTransport(const VertexTransportView& transport)
    : products_(transport),
      product_({transport.visibility_degree, transport.visibility_degree,
                std::min(2 * transport.visibility_degree, sh::kLargestLightDegree)}) {}

void ViewTransport::set_view(const VertexSelection& selection, const VertexGloss& gloss) {
  products_.check(selection, gloss);
  const VertexTransportView& transport = products_.transport();
  const std::size_t panels = selection.panel_count();
  irradiance_.assign({panels, transport.irradiance_channels, transport.irradiance_degree},
                     [&](std::size_t panel, std::span<float> values) {
                       products_.load_irradiance(selection, panel, values.data());
                     });
  const std::size_t size = sh::coefficient_count(transport.visibility_degree) * kBatchVertices;
  highlights_.assign(
      {panels, 1, product_.degrees().product}, [&](std::size_t panel, std::span<float> values) {
        thread_local Workspace work;
        if (work.visibility.size() < size) {
          work.visibility.resize(size);
          work.lobes.resize(size);
        }
        products_.load_visibility(selection, panel, work.visibility.data());
        products_.load_lobes(selection, panel, gloss, work.lobes.data());
        product_.multiply(std::span(work.visibility).first(size), std::span(work.lobes).first(size),
                          values, kBatchVertices, work.product);
      });
}

void ViewTransport::calculate(std::span<const float> light, const Tolerance& tolerance,
                              std::span<float> irradiance, std::span<float> highlights) {
  irradiance_.choose_bands(light, tolerance.irradiance);
  highlights_.choose_bands(light, tolerance.highlight);
  irradiance_.apply(light, irradiance);
  highlights_.apply(light, highlights);
}

}  // namespace rimlight
