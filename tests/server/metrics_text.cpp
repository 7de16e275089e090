#include "tests/server/metrics_text.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <limits>
#include <regex>
#include <set>

#include "core/base/error.h"

namespace rimlight::server::test {
namespace {

/// Where a histogram's buckets stand, by its name and its labels without `le`.
struct Buckets {
  double last_bound = -std::numeric_limits<double>::infinity();
  double last_count = 0;
  bool has_sum = false;
  double count = -1;
};

double number(const std::string& text, const std::string& where) {
  if (text == "+Inf") return std::numeric_limits<double>::infinity();
  char* end = nullptr;
  const double value = std::strtod(text.c_str(), &end);
  if (text.empty() || *end != '\0') throw Error(where, quote(text), "a number");
  return value;
}

class Reader {
 public:
  void line(const std::string& text, const std::string& where) {
    static const std::regex help(R"(# HELP ([a-zA-Z_:][a-zA-Z0-9_:]*) (?:[^\\\n]|\\\\|\\n)*)");
    static const std::regex type(
        R"(# TYPE ([a-zA-Z_:][a-zA-Z0-9_:]*) (counter|gauge|histogram|summary|untyped))");
    std::smatch match;
    if (std::regex_match(text, match, help)) {
      if (!helped_.insert(match[1]).second) throw Error(where, text, "HELP once");
    } else if (std::regex_match(text, match, type)) {
      begin_family(match[1], match[2], where);
    } else {
      sample(text, where);
    }
  }
  MetricsText finish() {
    for (const auto& [name, buckets] : histograms_) {
      if (!std::isinf(buckets.last_bound) || !buckets.has_sum ||
          buckets.count != buckets.last_count) {
        throw Error(name, "a histogram in part", "buckets to +Inf, a sum, and a count as the last");
      }
    }
    return std::move(result_);
  }

 private:
  void begin_family(const std::string& name, const std::string& type, const std::string& where) {
    if (!helped_.contains(name) || !result_.types.emplace(name, type).second) {
      throw Error(where, name, "TYPE once, after HELP");
    }
    if (type == "counter" && !name.ends_with("_total")) throw Error(where, name, "…_total");
    family_ = name;
    type_ = type;
  }

  void sample(const std::string& text, const std::string& where) {
    static const std::regex form(
        R"x(([a-zA-Z_:][a-zA-Z0-9_:]*)(?:\{((?:[a-zA-Z_][a-zA-Z0-9_]*="(?:[^"\\\n]|\\["\\n])*",?)*)\})? (\S+))x");
    std::smatch match;
    if (!std::regex_match(text, match, form)) throw Error(where, quote(text), "a sample");
    const std::string name = match[1], labels = match[2];
    const double value = number(match[3], where);
    const std::string series = labels.empty() ? name : name + "{" + labels + "}";
    if (!result_.samples.emplace(series, value).second) throw Error(where, series, "it once");
    if (type_ == "histogram") {
      histogram_sample(name, labels, value, where);
    } else if (name != family_) {
      throw Error(where, name, "a sample of " + family_);
    }
    if (type_ == "counter" && !(value >= 0)) throw Error(where, text, "a counter of at least 0");
  }

  void histogram_sample(const std::string& name, const std::string& labels, double value,
                        const std::string& where) {
    static const std::regex bound(R"x((.*?),?le="([^"]*)")x");
    std::smatch match;
    if (name == family_ + "_bucket" && std::regex_match(labels, match, bound)) {
      Buckets& buckets = histograms_[family_ + "{" + match[1].str() + "}"];
      const double upper = number(match[2], where);
      if (!(upper > buckets.last_bound) || !(value >= buckets.last_count)) {
        throw Error(where, labels, "bounds that rise and counts that do not fall");
      }
      buckets.last_bound = upper;
      buckets.last_count = value;
      return;
    }
    Buckets& buckets = histograms_[family_ + "{" + labels + "}"];
    if (name == family_ + "_sum") {
      buckets.has_sum = true;
    } else if (name == family_ + "_count") {
      buckets.count = value;
    } else {
      throw Error(where, name, "a part of the histogram " + family_);
    }
  }

  MetricsText result_;
  std::set<std::string> helped_;
  std::map<std::string, Buckets> histograms_;
  std::string family_, type_;
};

}  // namespace

double MetricsText::at(const std::string& sample) const {
  const auto found = samples.find(sample);
  if (found != samples.end()) return found->second;
  ADD_FAILURE() << "no sample " << sample;
  return std::numeric_limits<double>::quiet_NaN();
}

MetricsText parse_metrics(std::string_view text) {
  Reader reader;
  for (int line = 1; !text.empty(); ++line) {
    const std::string where = "line " + std::to_string(line);
    const std::size_t end = text.find('\n');
    if (end == std::string_view::npos) throw Error(where, "its end missing", "a line feed");
    reader.line(std::string(text.substr(0, end)), where);
    text.remove_prefix(end + 1);
  }
  return reader.finish();
}

}  // namespace rimlight::server::test
