// A session of curve edits from anywhere: what is read has finite curves in its first, a middle and
// its last frame.

#include <stdexcept>

#include "core/curves/curve_session_source.h"
#include "tests/fuzz/fuzz_target.h"

namespace {

using namespace rimlight;

void play(const CurveSession& session) {
  const int last = session.frame_count() - 1;
  for (const int frame : {0, last / 3, last}) {
    const CurveSession::Place place = session.place(frame);
    const CurveStroke& stroke = session.strokes[place.stroke];
    for (const Vec3f& value : curve_of(stroke.axis, stroke.at(place.step)).values) {
      if (!is_finite(value)) throw std::logic_error("a value of a curve that is not finite");
    }
  }
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return fuzz::expect_result_or_error(
      [&] { play(parse_curve_session(fuzz::text_of(data, size), "input")); });
}
