#include "core/transport/tile_transport.h"

#include "core/base/check.h"

namespace rimlight {
TileTransport prune(const TileTransport& tile, float least_energy) {
  RIMLIGHT_CHECK(least_energy >= 0);
  TileTransport kept;
  kept.column_step = tile.column_step;
  kept.run_offset.reserve(tile.run_offset.size());
  kept.runs.reserve(tile.runs.size());
  kept.run_offset.push_back(0);
  RunBuilder builder(least_energy);
  for (std::size_t column = 0; column < tile.column_count(); ++column) {
    for (RunCursor at(tile.run(column)); !at.at_end(); at.next()) builder.add(at.block());
    builder.finish(kept.runs);
    kept.run_offset.push_back(static_cast<std::uint32_t>(kept.runs.size()));
  }
  return kept;
}

Transport::Transport(std::span<const TileTransport> tiles) {
  RIMLIGHT_CHECK(!tiles.empty());
  column_step_ = tiles.front().column_step;
  tile_first_word_.push_back(0);
  for (const TileTransport& tile : tiles) {
    RIMLIGHT_CHECK(tile.column_step == column_step_);
    run_offset_.insert(run_offset_.end(), tile.run_offset.begin(), tile.run_offset.end());
    runs_.insert(runs_.end(), tile.runs.begin(), tile.runs.end());
    tile_first_word_.push_back(runs_.size());
  }
  view_ = TransportView({.tile_count = tiles.size(),
                         .column_count = column_step_.size(),
                         .column_step = column_step_,
                         .tile_first_word = tile_first_word_,
                         .run_offset = run_offset_,
                         .runs = runs_},
                        "transport in memory");
}

}  // namespace rimlight
