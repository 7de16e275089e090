#include "core/relight/plan_writer.h"

#include <array>
#include <bit>

namespace rimlight {
namespace {

/// What each layer of a column lacks.
std::array<Vec3f, kLayers> deltas_of(const PlanRequest& request, BandAction action,
                                     std::size_t column) {
  std::array<Vec3f, kLayers> deltas;
  deltas.fill(request.target.at(column));
  if (action == BandAction::reset) return deltas;
  for (std::size_t layer = 0; layer < kLayers; ++layer) {
    deltas[layer] = deltas[layer] - request.held.layer(layer).at(column);
  }
  return deltas;
}

/// Layers without blocks, which go with any other: to add them is no work.
LayerSet empty_layers(const PlanRequest& request, const Candidates& candidates,
                      std::size_t column) {
  LayerSet layers = 0;
  for (std::size_t layer = 0; candidates.are_parts() && layer < kLayers; ++layer) {
    if (request.part_bytes[part_of(column, layer)] == 0)
      layers |= static_cast<LayerSet>(1 << layer);
  }
  return layers;
}

/// Calls visit(column, layers) for the columns of a set of candidates, in ascending order.
template <typename Visit>
void for_each_column(const Candidates& candidates, const ColumnSet& columns, const Visit& visit) {
  std::size_t last = 0;
  LayerSet layers = 0;
  for (std::size_t word = 0; word < columns.words().size(); ++word) {
    for (std::uint64_t bits = columns.words()[word]; bits != 0; bits &= bits - 1) {
      const std::size_t candidate = 64 * word + static_cast<std::size_t>(std::countr_zero(bits));
      const std::size_t column = candidates.column_of(candidate);
      if (column != last && layers != 0) visit(last, layers);
      if (column != last) layers = 0;
      last = column;
      layers |= candidates.layers_of(candidate);
    }
  }
  if (layers != 0) visit(last, layers);
}

}  // namespace

std::size_t ColumnSet::size() const {
  std::size_t size = 0;
  for (const std::uint64_t word : words_) size += static_cast<std::size_t>(std::popcount(word));
  return size;
}

void write_plan(const PlanRequest& request, const Candidates& candidates,
                const std::vector<BandAction>& actions, const ColumnSet& columns,
                UpdatePlan& plan) {
  plan.bands.assign(actions.size(), {});
  plan.columns.clear();
  plan.columns.reserve(columns.size());
  std::size_t band = 0;
  std::size_t band_end = request.basis.band_begin(1);
  for_each_column(candidates, columns, [&](std::size_t column, LayerSet layers) {
    for (; column >= band_end; ++band) {
      band_end = request.basis.band_begin(static_cast<int>(band) + 2);
    }
    const std::size_t before = plan.columns.size();
    append_deltas(column, deltas_of(request, actions[band], column),
                  layers | empty_layers(request, candidates, column), plan.columns);
    plan.bands[band].count += plan.columns.size() - before;
  });
  std::size_t first = 0;
  for (band = 0; band < actions.size(); ++band) {
    BandUpdate& update = plan.bands[band];
    update.first = first;
    first += update.count;
    const bool nothing = actions[band] == BandAction::increment && update.count == 0;
    update.action = nothing ? BandAction::hold : actions[band];
  }
}

}  // namespace rimlight
