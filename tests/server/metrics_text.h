#pragma once

#include <map>
#include <string>
#include <string_view>

namespace rimlight::server::test {

/// A body of /metrics, read by the letter of Prometheus' text format 0.0.4.
struct MetricsText {
  std::map<std::string, std::string> types;  // of families, by name
  std::map<std::string, double> samples;     // by name and labels: `name{label="value"}`

  /// The sample; a test failure and NaN when it is not there.
  double at(const std::string& sample) const;
};

/// Throws Error naming the line: a name, label or number that is none, a sample whose family has no
/// HELP and TYPE before it, or stands apart from it, a series twice, a histogram whose buckets are
/// not cumulative or do not end in its count, a counter whose name does not end in _total or that
/// is negative, a text whose last line has no end.
MetricsText parse_metrics(std::string_view text);

}  // namespace rimlight::server::test
