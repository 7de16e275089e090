#include "cli/load_report.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "core/image/codec.h"
#include "server/session/baked_scene.h"

namespace rimlight {
namespace {

/// "3 of 8 clients" with the first reason, or how many were fine.
LoadCheck check_all(const std::string& name, const std::vector<LoadRecord>& records,
                    const std::function<std::string(const LoadRecord&)>& find_fault) {
  std::size_t faults = 0;
  std::string first;
  for (const LoadRecord& record : records) {
    const std::string fault = find_fault(record);
    if (fault.empty()) continue;
    if (faults++ == 0) first = fault;
  }
  if (faults == 0) return {name, !records.empty(), std::to_string(records.size()) + " clients"};
  return {name, false,
          std::to_string(faults) + " of " + std::to_string(records.size()) + " clients: " + first};
}

std::string fault_of_acks(const LoadRecord& record) {
  if (record.edits_acknowledged == record.edits_sent) return {};
  return std::to_string(record.edits_acknowledged) + " of " + std::to_string(record.edits_sent) +
         " edits acknowledged";
}

std::string fault_of_last_frame(const LoadRecord& record) {
  if (!record.last_header) return "no frame came";
  if (!record.last_header->exact) return "the last frame is not exact";
  if (record.last_header->revision != record.state_revision) {
    return "the last frame shows revision " + std::to_string(record.last_header->revision.number) +
           " of " + std::to_string(record.state_revision.number);
  }
  return {};
}

/// How many bytes of the last frame differ from the exact render of its state, in words.
std::string fault_of_pixels(const LoadRecord& record, server::FrameSource& source) {
  if (!fault_of_last_frame(record).empty()) return "no exact last frame";
  const Rgb8Image got =
      decode_png(record.last_payload.data(), record.last_payload.size(), "the last frame");
  Rgb8Image expected;
  FrameReport report;
  if (!source.render_exact(record.state, expected, report, {})) return "the render was abandoned";
  if (got.width != expected.width || got.height != expected.height) return "another size";
  std::size_t different = 0;
  for (std::size_t i = 0; i < expected.bytes.size(); ++i) {
    different += expected.bytes[i] != got.bytes[i];
  }
  return different == 0 ? "" : std::to_string(different) + " bytes of the pixels differ";
}

}  // namespace

double percentile(std::vector<double>& values, double share) {
  if (values.empty()) return 0;
  std::sort(values.begin(), values.end());
  const double rank = std::ceil(share * static_cast<double>(values.size()));
  return values[static_cast<std::size_t>(std::max(rank, 1.0)) - 1];
}

namespace {

LoadReport::Slow slow_of(const LoadRecord& record) {
  LoadReport::Slow slow;
  slow.frames_per_second = static_cast<double>(record.frames) / record.motion_seconds;
  slow.rungs = record.rungs;
  std::vector<double> latencies = record.latencies_ms;
  slow.latency_p50_ms = percentile(latencies, 0.50);
  slow.latency_p99_ms = percentile(latencies, 0.99);
  return slow;
}

const char* name_of(server::Codec codec) { return codec == server::Codec::vp8 ? "vp8" : "jpeg"; }

double bytes_per_frame(const RungCount& count) {
  return static_cast<double>(count.bytes) /
         static_cast<double>(std::max<std::int64_t>(count.frames, 1));
}

nlohmann::json rungs_to_json(const RungCounts& rungs) {
  nlohmann::json list = nlohmann::json::array();
  for (const auto& [rung, count] : rungs) {
    list.push_back({{"rung", rung},
                    {"codec", name_of(count.codec)},
                    {"frames", count.frames},
                    {"bytes_per_frame", bytes_per_frame(count)}});
  }
  return list;
}

nlohmann::json slow_to_json(const std::optional<LoadReport::Slow>& slow) {
  if (!slow) return nullptr;
  return {{"frames_per_second", slow->frames_per_second},
          {"latency_ms", {{"p50", slow->latency_p50_ms}, {"p99", slow->latency_p99_ms}}},
          {"rungs", rungs_to_json(slow->rungs)}};
}

std::string rungs_to_text(const RungCounts& rungs) {
  std::string text;
  char line[128];
  for (const auto& [rung, count] : rungs) {
    std::snprintf(line, sizeof line, "        rung %d (%s): %lld frames of %.0f bytes\n", rung,
                  name_of(count.codec), static_cast<long long>(count.frames),
                  bytes_per_frame(count));
    text += line;
  }
  return text;
}

}  // namespace

LoadReport summarize(const std::vector<LoadRecord>& records, ScriptKind script) {
  LoadReport report;
  std::vector<double> latencies;
  std::int64_t frames = 0;
  std::int64_t bytes = 0;
  for (const LoadRecord& record : records) {
    if (record.is_slow) {
      report.slow = slow_of(record);
      continue;
    }
    report.exact_after_ms = std::max(report.exact_after_ms, record.exact_after_ms);
    for (const auto& [rung, count] : record.rungs) {
      RungCount& all = report.rungs[rung];
      all.codec = count.codec;
      all.frames += count.frames;
      all.bytes += count.bytes;
    }
    frames += record.frames;
    bytes += record.bytes;
    report.skipped += record.skipped;
    if (record.motion_seconds > 0) {
      report.frames_per_second += static_cast<double>(record.frames) / record.motion_seconds;
    }
    latencies.insert(latencies.end(), record.latencies_ms.begin(), record.latencies_ms.end());
  }
  report.latency_p50_ms = percentile(latencies, 0.50);
  report.latency_p95_ms = percentile(latencies, 0.95);
  report.latency_p99_ms = percentile(latencies, 0.99);
  if (frames > 0) report.bytes_per_frame = static_cast<double>(bytes) / static_cast<double>(frames);

  report.checks.push_back(check_all("the protocol is kept", records, [](const LoadRecord& record) {
    return record.failures.empty() ? std::string() : record.failures.front();
  }));
  report.checks.push_back(check_all("revisions never go back", records, [](const LoadRecord& r) {
    return r.revisions_ascend ? "" : std::string("a frame shows an older revision than before it");
  }));
  report.checks.push_back(check_all("every edit is acknowledged", records, fault_of_acks));
  report.checks.push_back(check_all("frames in motion change", records, [=](const LoadRecord& r) {
    if (r.edits_sent > 0 && r.frames == 0) return std::string("no frame in motion counts");
    return r.unchanged == 0 || script == ScriptKind::any
               ? std::string()
               : std::to_string(r.unchanged) + " frames show nothing new";
  }));
  report.checks.push_back(check_all("the last frame is exact", records, fault_of_last_frame));
  return report;
}

LoadCheck compare_with_bake(const std::vector<LoadRecord>& records, const std::string& bake_folder,
                            const VertexSettings& vertices) {
  const std::string name = "the last frame equals rimlight render";
  if (bake_folder.empty()) return {name, std::nullopt, "not run: no --bake"};
  const server::ServedScene scene = server::open_scene(bake_folder, {{}, vertices});
  const auto source = scene.make_source();
  return check_all(name, records,
                   [&](const LoadRecord& record) { return fault_of_pixels(record, *source); });
}

bool LoadReport::passed() const {
  return std::all_of(checks.begin(), checks.end(),
                     [](const LoadCheck& check) { return check.pass.value_or(true); });
}

nlohmann::json LoadReport::to_json() const {
  nlohmann::json list = nlohmann::json::array();
  for (const LoadCheck& check : checks) {
    nlohmann::json verdict = nullptr;
    if (check.pass) verdict = *check.pass;
    list.push_back({{"name", check.name}, {"pass", verdict}, {"detail", check.detail}});
  }
  return {
      {"frames_per_second", frames_per_second},
      {"latency_ms", {{"p50", latency_p50_ms}, {"p95", latency_p95_ms}, {"p99", latency_p99_ms}}},
      {"bytes_per_frame", bytes_per_frame},
      {"skipped", skipped},
      {"exact_after_ms", exact_after_ms},
      {"rungs", rungs_to_json(rungs)},
      {"slow", slow_to_json(slow)},
      {"checks", list}};
}

std::string LoadReport::to_text() const {
  char line[256];
  std::snprintf(line, sizeof line,
                "%.1f frames/s, latency p50 %.1f ms, p95 %.1f ms, p99 %.1f ms, %.0f bytes a frame, "
                "%lld skipped\n",
                frames_per_second, latency_p50_ms, latency_p95_ms, latency_p99_ms, bytes_per_frame,
                static_cast<long long>(skipped));
  std::string text = line;
  text += rungs_to_text(rungs);
  std::snprintf(line, sizeof line, "exact %.0f ms after the last edit\n", exact_after_ms);
  text += line;
  if (slow) {
    std::snprintf(line, sizeof line,
                  "the slow client: %.1f frames/s, latency p50 %.1f ms, p99 %.1f ms\n",
                  slow->frames_per_second, slow->latency_p50_ms, slow->latency_p99_ms);
    text += line + rungs_to_text(slow->rungs);
  }
  for (const LoadCheck& check : checks) {
    const char* const verdict = !check.pass ? "    --" : *check.pass ? "    ok" : "FAILED";
    text += std::string(verdict) + "  " + check.name + " (" + check.detail + ")\n";
  }
  return text;
}

}  // namespace rimlight
