#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "core/curves/curve_session.h"
#include "core/light/environment.h"
#include "core/transport/bake_folder.h"

namespace rimlight {

/// Something that makes T′ stale, and how its image became exact: shown quickly at once, exactly
/// when T′ is made again. Errors as CurveFrameRow's.
struct StaleCurveRow {
  std::string cause;  // "environment", "rotation", "other axis"
  std::string light;
  double quick_ms = 0;  // the change to the quick image, its estimate included
  double error_l2 = 0;  // of the quick image
  double estimate = 0;  // as the frame says it, from a sample of rows
  double exact_ms = 0;  // the change to the exact image: T′ of the axes shown
  double all_ms = 0;    // and to the norms and T′ of the other axes
};

/// Changes the light of a session that has been played to its end: to each of the bake's
/// other environments and back to `light`, then by turns of 1, 10 and 90 degrees; at last a curve
/// over θ_d and then at once one over θ_h. As CurveLayer's frames show it, within a budget of 16
/// ms. The session fits the bake.
std::vector<StaleCurveRow> measure_stale_curves(const std::shared_ptr<const Bake>& bake,
                                                const CurveSession& session,
                                                const std::shared_ptr<const Environment>& light,
                                                const std::function<void(double share)>& progress);

}  // namespace rimlight
