#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "core/relight/policy.h"
#include "core/relight/relighter.h"

namespace rimlight {

/// How a frame is approximated; policies.h says what each does.
enum class PolicyKind { linear, nwa, bi, pbi, benefit };
/// How `pbi` finds the bands to reset (Overbeck 2006, §6.2).
enum class BandTest { simple, dealer, exhaustive };
/// What the size of a coefficient is weighted by when columns are chosen: nothing, the area of its
/// wavelet, or the norm of its column of M.
enum class Selection { unweighted, area, transport };

/// One policy. As text: KIND[:BAND_TEST][:SELECTION], where only `pbi` has a band test, and
/// `linear` and `benefit` have no selection: "pbi", "pbi:dealer:transport", "nwa:unweighted".
struct PolicySettings {
  PolicyKind kind = PolicyKind::pbi;
  BandTest band_test = BandTest::simple;
  Selection selection = Selection::area;

  friend bool operator==(const PolicySettings&, const PolicySettings&) = default;
};

/// Reads that text; what it leaves out is the default. Throws Error naming `where`, with the names
/// that could stand there.
PolicySettings parse_policy(std::string_view text, const std::string& where);

/// The shortest text that parse_policy() reads as these settings.
std::string policy_name(const PolicySettings& settings);

std::unique_ptr<const UpdatePolicy> make_policy(const PolicySettings& settings);

/// What an image has to be held as for the policy: by band for `pbi`, whose point it is. `benefit`
/// can reset single bands too, but that mends less than what moving their images costs.
HeldImages held_images_for(const PolicySettings& settings);

}  // namespace rimlight
