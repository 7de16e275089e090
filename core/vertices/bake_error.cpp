#include "core/vertices/bake_error.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <optional>

#include "core/basis/sh.h"
#include "core/basis/sh_zonal.h"

namespace rimlight {
namespace {

using nlohmann::json;
constexpr double kPi = std::numbers::pi;
/// Of squares, against what replicates say.
constexpr double kOfReplicates = 0.5;
/// Larger ones are no error but nonsense.
constexpr double kMostError = 100;

bool is_error(const json& value) {
  return value.is_number() && value.get<double>() >= 0 && value.get<double>() <= kMostError;
}

const json* member(const json& object, const char* name) {
  if (!object.is_object()) return nullptr;
  const auto found = object.find(name);
  return found == object.end() ? nullptr : &*found;
}

std::optional<double> number(const json& object, const char* part, const char* name) {
  const json* const of = member(object, part);
  const json* const value = of != nullptr ? member(*of, name) : nullptr;
  if (value == nullptr || !is_error(*value)) return std::nullopt;
  return value->get<double>();
}

/// Squares of a member's numbers by band; empty when it is no list of so many errors.
std::vector<double> squares_of(const json* bands, const char* name, int degree) {
  const json* const list = bands != nullptr ? member(*bands, name) : nullptr;
  const auto count = static_cast<std::size_t>(degree) + 1;
  if (list == nullptr || !list->is_array() || list->size() < count) return {};
  std::vector<double> squares;
  for (std::size_t l = 0; l < count; ++l) {
    if (!is_error((*list)[l])) return {};
    const double rms = (*list)[l].get<double>();
    squares.push_back(kOfReplicates * rms * rms);
  }
  return squares;
}

/// A squared norm over the sphere, as mean squares of a coefficient, spread like a clamped cosine.
std::vector<double> like_cosine(double norm_squared, int degree) {
  const sh::ZonalLobe lobe = sh::clamped_cosine_lobe(degree);
  std::vector<double> result;
  double sum = 0;
  for (const double value : lobe) sum += value * value;
  for (std::size_t l = 0; l < lobe.size(); ++l) {
    result.push_back(norm_squared * lobe[l] * lobe[l] / sum / static_cast<double>(2 * l + 1));
  }
  return result;
}

void add(const std::vector<double>& more, std::vector<double>& to) {
  to.resize(std::max(to.size(), more.size()));
  for (std::size_t l = 0; l < more.size(); ++l) to[l] += more[l];
}

/// The degree that was asked for: what was measured is of so many coefficients.
int degree_asked(const json& settings, int degree) {
  const json* const asked = member(settings, "degree");
  if (asked == nullptr || !asked->is_number_integer()) return degree;
  const auto found = asked->get<std::int64_t>();
  return found > degree && found <= sh::kLargestDegree ? static_cast<int>(found) : degree;
}

VertexBakeError::Sampling sampling_of(const json& measured, int degree) {
  VertexBakeError::Sampling sampling;
  const json* const visibility = member(measured, "visibility");
  const json* const bands = visibility != nullptr ? member(*visibility, "rms_by_band") : nullptr;
  sampling.matt = squares_of(bands, "irradiance", degree);
  sampling.glossy = squares_of(bands, "irradiance_beside_highlight", degree);
  sampling.visibility = squares_of(bands, "visibility", degree);
  const auto rms = number(measured, "visibility", "rms_error");
  if (bands == nullptr && rms) {
    const double square = kOfReplicates * *rms * *rms;
    const auto count = static_cast<std::size_t>(degree) + 1;
    sampling.matt.assign(count, square);
    sampling.glossy.assign(count, square / 4);
    sampling.visibility.assign(count, 3 * square / 4);
  }
  if (const auto indirect = number(measured, "indirect", "rms_error")) {
    const auto coefficients = static_cast<double>(sh::coefficient_count(degree));
    const auto more = like_cosine(kOfReplicates * *indirect * *indirect * coefficients, degree);
    add(more, sampling.matt);
    add(more, sampling.glossy);
  }
  return sampling;
}

/// Bands beyond those stored, evenly; `whole_squared` is what relative errors are a share of.
std::vector<double> bands_left_out(const json& left_out, const char* part, double whole_squared) {
  const auto relative = number(left_out, part, "relative_error");
  const auto stored = number(left_out, part, "degree_stored");
  const auto asked = number(left_out, part, "degree_asked");
  if (!relative || !stored || !asked || !(*stored < *asked) || *asked > sh::kLargestDegree) {
    return {};
  }
  const int first = static_cast<int>(*stored) + 1, last = static_cast<int>(*asked);
  const auto count =
      static_cast<double>(sh::coefficient_count(last) - sh::coefficient_count(first - 1));
  std::vector<double> squares(static_cast<std::size_t>(last) + 1);
  for (int l = first; l <= last; ++l) {
    squares[static_cast<std::size_t>(l)] = *relative * *relative * whole_squared / count;
  }
  return squares;
}

}  // namespace

VertexBakeError bake_error_of(const json& settings, const json& measured, const json& left_out,
                              int degree) {
  constexpr double kCosineSquared = 2 * kPi / 3, kHemisphereSquared = 2 * kPi;
  VertexBakeError error;
  const json* const asked = member(settings, "error");
  if (asked != nullptr && is_error(*asked)) error.asked = asked->get<double>();
  const json* const transfer = member(settings, "transfer");
  const bool is_open = transfer != nullptr && *transfer == "unshadowed";
  error.is_known = is_open || number(measured, "visibility", "rms_error").has_value();
  error.sampling = sampling_of(measured, degree_asked(settings, degree));
  error.irradiance_left_out = bands_left_out(left_out, "irradiance", kCosineSquared);
  error.visibility_left_out = bands_left_out(left_out, "visibility", kHemisphereSquared);
  if (const auto colour = number(left_out, "irradiance_colour", "relative_error")) {
    add(like_cosine(*colour * *colour * kCosineSquared, degree), error.irradiance_left_out);
  }
  return error;
}

}  // namespace rimlight
