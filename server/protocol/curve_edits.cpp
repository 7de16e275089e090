#include "server/protocol/curve_edits.h"

namespace rimlight::server {
namespace {

using nlohmann::json;

/// How many there may be, check_curve_points() and check_curve_values() say.
std::vector<CurvePoint> read_points(const JsonReader& reader) {
  std::vector<CurvePoint> points;
  for (const JsonReader& element : reader.elements()) {
    const std::vector<double> v = element.numbers(4);
    points.push_back({v[0], {v[1], v[2], v[3]}});
  }
  check_curve_points(points, reader.where());
  return points;
}

std::vector<Vec3f> read_values(const JsonReader& reader) {
  std::vector<Vec3d> values;
  for (const JsonReader& element : reader.elements()) {
    const std::vector<double> v = element.numbers(3);
    values.emplace_back(v[0], v[1], v[2]);
  }
  check_curve_values(values, reader.where());
  return {values.begin(), values.end()};
}

CurveScale read_scale(const JsonReader& reader) {
  static const std::vector<std::string> kScales{"linear", "logarithmic"};
  return reader.one_of(kScales) == 0 ? CurveScale::linear : CurveScale::logarithmic;
}

}  // namespace

std::string_view axis_name(CurveAxis axis) {
  return axis == CurveAxis::half_angle ? "half_angle" : "difference_angle";
}

CurveEdit read_curve(const JsonReader& reader) {
  CurveEdit curve;
  if (reader.value().is_null()) return curve;
  if (const auto values = reader.optional_member("values")) {
    reader.allow_only({"values"});
    curve.values = read_values(*values);
    return curve;
  }
  reader.allow_only({"scale", "points"});
  curve.scale = read_scale(reader.member("scale"));
  curve.points = read_points(reader.member("points"));
  return curve;
}

json curve_to_json(const CurveEdit& curve) {
  json list = json::array();
  if (!curve.values.empty()) {
    for (const Vec3f& v : curve.values) list.push_back({v.x, v.y, v.z});
    return {{"values", list}};
  }
  for (const auto& [position, v] : curve.points) list.push_back({position, v.x, v.y, v.z});
  return {{"scale", curve.scale == CurveScale::linear ? "linear" : "logarithmic"},
          {"points", list}};
}

}  // namespace rimlight::server
