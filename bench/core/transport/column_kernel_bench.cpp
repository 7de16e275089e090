// Columns of a synthetic transport of 262,144 receivers × 24,576 columns × RGB, with 1 %, 5 % or
// 20 % of its luma blocks and a tenth of that of each chroma's, added to B: 30 columns chosen
// afresh each time, and all of them; and all of them for several sessions. Beside the time:
//
//   ns_block, ns_number  median time ÷ stored blocks (and sessions), and ÷ their 8 numbers each
//   of_read_limit        median time ÷ (bytes of the matrix that must move ÷ read bandwidth), the
//                        bandwidth measured in this run on as many threads. B itself is not
//                        counted: it can stay in a cache
//   of_eigen             median time of Eigen's CSC `y += d * T.col(j)` on one thread ÷ this time,
//                        on the same share of non-zeros, measured in this run (30 columns only)
//   of_single            median time of a call for each session ÷ this time, in turn in this run
#include <benchmark/benchmark.h>

#include <Eigen/SparseCore>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>
#include <functional>
#include <limits>
#include <memory>
#include <vector>

#include "core/base/parallel.h"
#include "core/math/random.h"
#include "core/transport/column_kernel.h"
#include "core/transport/tile_transport.h"

namespace rimlight {
namespace {

constexpr std::size_t kTiles = 64;
constexpr std::size_t kColumns = 24576;
constexpr std::size_t kFewColumns = 30;
constexpr int kEigenColumns = 2048;  // of which 30 are chosen: more than any cache holds

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// Blocks of a column, each kept with probability `density`: the gaps between them are geometric.
template <typename Visit>
void random_subset(Random& random, double density, std::size_t count, const Visit& visit) {
  const double scale = 1 / std::log1p(-density);
  for (auto i = std::log1p(-random.uniform()) * scale; i < static_cast<double>(count);
       i += 1 + std::floor(std::log1p(-random.uniform()) * scale)) {
    visit(static_cast<std::size_t>(i));
  }
}

/// Blocks as a bake of the default scene at 50 dB has them: a luma plane of the density asked for,
/// a fifth of that in chroma; most numbers in 8 or 4 bits.
void add_random_block(Random& random, std::size_t plane, std::size_t index, RunBuilder& builder) {
  RunBlock block{plane, static_cast<std::uint16_t>(index), {}};
  const double u = random.uniform();
  const float size = u < 0.4 ? 7.0f : u < 0.97 ? 127.0f : 32767.0f;
  const std::uint64_t bits = random.bits();
  for (std::size_t i = 0; i < kBlockReceivers; ++i) {
    block.value[i] = size * static_cast<float>((bits >> (8 * i) & 255) + 1) / 256;
  }
  block.value[0] = size;
  builder.add(block);
}

TileTransport random_tile(std::size_t tile, double density) {
  Random random(1, tile);
  TileTransport result;
  result.column_step.assign(kColumns, 0x1p-20f);
  result.run_offset.push_back(0);
  RunBuilder builder(0);
  for (std::size_t column = 0; column < kColumns; ++column) {
    for (std::size_t plane = 0; plane < kPlanes; ++plane) {
      random_subset(random, plane == 0 ? density : density / 10, kTileBlocks,
                    [&](std::size_t index) { add_random_block(random, plane, index, builder); });
    }
    builder.finish(result.runs);
    result.run_offset.push_back(static_cast<std::uint32_t>(result.runs.size()));
  }
  return result;
}

/// One density's transport at a time is kept.
const TransportView& transport(double density) {
  static std::unique_ptr<Transport> made;
  static double made_density = 0;
  if (made_density != density) {
    made.reset();
    std::vector<TileTransport> tiles(kTiles);
    parallel_for(kTiles, [&](std::size_t tile) { tiles[tile] = random_tile(tile, density); });
    made = std::make_unique<Transport>(tiles);
    made_density = density;
  }
  return made->view();
}

/// Bytes a second, reading half a GiB on the threads in use; the best of five.
double read_bandwidth() {
  static const AlignedVector<std::uint64_t> memory(std::size_t{1} << 26, 1);
  constexpr std::size_t kChunks = 64;
  std::vector<std::uint64_t> sums(kChunks);
  double best = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 5; ++i) {
    const auto start = Clock::now();
    parallel_for(kChunks, [&](std::size_t chunk) {
      const std::size_t size = memory.size() / kChunks;
      const std::uint64_t* const first = memory.data() + chunk * size;
      std::uint64_t lanes[8] = {};
      for (std::size_t k = 0; k < size; k += 8) {
        for (std::size_t lane = 0; lane < 8; ++lane) lanes[lane] += first[k + lane];
      }
      for (const std::uint64_t lane : lanes) sums[chunk] += lane;
    });
    benchmark::DoNotOptimize(sums.data());
    best = std::min(best, seconds_since(start));
  }
  return static_cast<double>(memory.size() * sizeof(std::uint64_t)) / best;
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

/// Median seconds of Eigen for 30 columns.
double eigen_seconds(double density) {
  constexpr int kRows = static_cast<int>(kTiles * kTileReceivers * 3);
  Eigen::SparseMatrix<float, Eigen::ColMajor> matrix(kRows, kEigenColumns);
  matrix.reserve(static_cast<Eigen::Index>(1.1 * density * kRows * kEigenColumns));
  Random random(2);
  for (int column = 0; column < kEigenColumns; ++column) {
    matrix.startVec(column);
    random_subset(random, density, kRows, [&](std::size_t row) {
      matrix.insertBack(static_cast<int>(row), column) = 0.5f;
    });
  }
  matrix.finalize();
  Eigen::VectorXf y = Eigen::VectorXf::Zero(kRows);
  std::vector<double> seconds;
  for (int i = 0; i < 15; ++i) {
    const auto start = Clock::now();
    for (std::size_t k = 0; k < kFewColumns; ++k) {
      y += 0.7f * matrix.col(static_cast<int>(random.below(kEigenColumns)));
    }
    benchmark::DoNotOptimize(y.data());
    seconds.push_back(seconds_since(start));
  }
  return median(seconds);
}

std::vector<ColumnDelta> random_columns(Random& random, std::size_t count) {
  std::vector<ColumnDelta> columns;
  for (std::size_t i = 0; i < count; ++i) {
    const auto column = count == kColumns ? i : random.below(kColumns);
    columns.push_back({static_cast<std::uint32_t>(column), {0.7f, -0.3f, 0.2f}});
  }
  std::ranges::sort(columns, {}, &ColumnDelta::column);
  return columns;
}

/// What adding columns reads.
struct Moved {
  double bytes = 0, blocks = 0;
};
Moved moved_by(const TransportView& view, const std::vector<ColumnDelta>& columns) {
  std::size_t bytes = kTiles * columns.size() * sizeof(std::uint32_t), blocks = 0;
  for (std::size_t tile = 0; tile < kTiles; ++tile) {
    for (const ColumnDelta& c : columns) {
      const ColumnRun run = view.run(tile, c.column);
      bytes += run.words().size_bytes();
      if (!run.empty()) blocks += run.block_count();
    }
  }
  return {static_cast<double>(bytes), static_cast<double>(blocks)};
}

void count_times(benchmark::State& state, double seconds, const Moved& moved, double additions) {
  state.SetLabel(column_kernel_target());
  state.counters["of_read_limit"] = seconds / (moved.bytes / read_bandwidth());
  state.counters["median_ms"] = 1e3 * seconds;
  state.counters["ns_block"] = 1e9 * seconds / (additions * moved.blocks);
  state.counters["ns_number"] = 1e9 * seconds / (additions * moved.blocks * kBlockReceivers);
}

void add(benchmark::State& state, std::size_t count) {
  const double density = static_cast<double>(state.range(1)) / 100;
  set_thread_count(static_cast<int>(state.range(0)));
  const TransportView& view = transport(density);
  ReceiverValues held(kTiles);
  Random random(3);
  std::vector<double> seconds;
  Moved moved;
  for (auto _ : state) {
    const auto columns = random_columns(random, count);
    const auto start = Clock::now();
    parallel_for(kTiles,
                 [&](std::size_t tile) { add_columns(view, tile, columns, held.tile(tile)); });
    const double once = seconds_since(start);
    state.SetIterationTime(once);
    seconds.push_back(once);
    moved = moved_by(view, columns);  // nearly the same each time
  }
  count_times(state, median(seconds), moved, 1);
  if (count == kFewColumns) {
    state.counters["of_eigen"] = eigen_seconds(density) / median(seconds);
  }
  set_thread_count(0);
}

/// All columns for several sessions in one call a tile, and in a call for each.
void add_to_all(benchmark::State& state) {
  const auto sessions = static_cast<std::size_t>(state.range(1));
  set_thread_count(static_cast<int>(state.range(0)));
  const TransportView& view = transport(static_cast<double>(state.range(2)) / 100);
  Random random(3);
  const auto columns = random_columns(random, kColumns);
  std::vector<std::uint32_t> ids;
  for (const ColumnDelta& column : columns) ids.push_back(column.column);
  const std::vector<Vec3f> deltas(sessions * kColumns, columns[0].delta);
  std::vector<ReceiverValues> held(sessions, ReceiverValues(kTiles));
  std::vector<double> together, single;
  for (auto _ : state) {
    const auto start = Clock::now();
    parallel_for(kTiles, [&](std::size_t tile) {
      std::vector<float*> tiles;
      for (ReceiverValues& of_session : held) tiles.push_back(of_session.tile(tile));
      add_columns_to_all(view, tile, {ids, deltas}, tiles);
    });
    together.push_back(seconds_since(start));
    state.SetIterationTime(together.back());
    const auto middle = Clock::now();
    for (ReceiverValues& of_session : held) {
      parallel_for(kTiles, [&](std::size_t tile) {
        add_columns(view, tile, columns, of_session.tile(tile));
      });
    }
    single.push_back(seconds_since(middle));
  }
  count_times(state, median(together), moved_by(view, columns), static_cast<double>(sessions));
  state.counters["of_single"] = median(single) / median(together);
  set_thread_count(0);
}

// The density last: a transport is made when it changes.
BENCHMARK_CAPTURE(add, 30_columns, kFewColumns)
    ->ArgNames({"threads", "percent"})
    ->ArgsProduct({{1, 2}, {1, 5}})
    ->Unit(benchmark::kMillisecond)
    ->UseManualTime();
BENCHMARK_CAPTURE(add, all_columns, kColumns)
    ->ArgNames({"threads", "percent"})
    ->ArgsProduct({{1, 2}, {1, 5, 20}})
    ->Unit(benchmark::kMillisecond)
    ->UseManualTime();
BENCHMARK(add_to_all)
    ->ArgNames({"threads", "sessions", "percent"})
    ->ArgsProduct({{1, 2}, {2, 8}, {1, 5, 20}})
    ->Unit(benchmark::kMillisecond)
    ->UseManualTime();

}  // namespace
}  // namespace rimlight
