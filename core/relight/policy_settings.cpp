#include "core/relight/policy_settings.h"

#include <algorithm>
#include <array>
#include <optional>

#include "core/base/check.h"
#include "core/base/error.h"
#include "core/relight/policies.h"

namespace rimlight {
namespace {

using Names = std::span<const std::string_view>;

// In the order of the enumerators.
constexpr std::array<std::string_view, 5> kKinds = {"linear", "nwa", "bi", "pbi", "benefit"};
constexpr std::array<std::string_view, 3> kBandTests = {"simple", "dealer", "exhaustive"};
constexpr std::array<std::string_view, 3> kSelections = {"unweighted", "area", "transport"};

template <typename Enum>
std::optional<Enum> find(Names names, std::string_view text) {
  const auto found = std::ranges::find(names, text);
  if (found == names.end()) return std::nullopt;
  return static_cast<Enum>(found - names.begin());
}

std::string listed(Names names) {
  std::string text;
  for (const std::string_view name : names) text += (text.empty() ? "" : ", ") + quote(name);
  return text;
}

bool has_selection(PolicyKind kind) {
  return kind == PolicyKind::nwa || kind == PolicyKind::bi || kind == PolicyKind::pbi;
}

/// What may follow a kind, for the error of something else.
std::string expected_after(PolicyKind kind) {
  const std::string name = quote(kKinds[static_cast<std::size_t>(kind)]);
  if (!has_selection(kind)) return name + " alone";
  const bool tests = kind == PolicyKind::pbi;
  return "after " + name + (tests ? ": at most one of " + listed(kBandTests) + ", then" : ":") +
         " at most one of " + listed(kSelections);
}

/// Cuts the text before the next colon off.
std::string_view take_part(std::string_view& text) {
  const std::size_t colon = text.find(':');
  const std::string_view part = text.substr(0, colon);
  text = colon == std::string_view::npos ? std::string_view() : text.substr(colon);
  return part;
}

}  // namespace

PolicySettings parse_policy(std::string_view text, const std::string& where) {
  std::string_view rest = text;
  PolicySettings settings;
  const auto kind = find<PolicyKind>(kKinds, take_part(rest));
  if (!kind) throw Error(where, quote(text), "one of " + listed(kKinds));
  settings.kind = *kind;
  bool band_test_open = *kind == PolicyKind::pbi, selection_open = has_selection(*kind);
  while (!rest.empty()) {
    rest.remove_prefix(1);  // the colon
    const std::string_view part = take_part(rest);
    const auto band_test = find<BandTest>(kBandTests, part);
    const auto selection = find<Selection>(kSelections, part);
    if (band_test && band_test_open) {
      settings.band_test = *band_test;
    } else if (selection && selection_open) {
      settings.selection = *selection;
      selection_open = false;
    } else {
      throw Error(where, quote(text), expected_after(*kind));
    }
    band_test_open = false;
  }
  return settings;
}

std::string policy_name(const PolicySettings& settings) {
  std::string name(kKinds[static_cast<std::size_t>(settings.kind)]);
  const auto add = [&name](std::string_view part) { name.append(":").append(part); };
  if (settings.kind == PolicyKind::pbi && settings.band_test != BandTest::simple) {
    add(kBandTests[static_cast<std::size_t>(settings.band_test)]);
  }
  if (has_selection(settings.kind) && settings.selection != Selection::area) {
    add(kSelections[static_cast<std::size_t>(settings.selection)]);
  }
  return name;
}

std::unique_ptr<const UpdatePolicy> make_policy(const PolicySettings& settings) {
  switch (settings.kind) {
    case PolicyKind::linear:
      return std::make_unique<LinearPolicy>();
    case PolicyKind::nwa:
      return std::make_unique<NwaPolicy>(settings.selection);
    case PolicyKind::bi:
      return std::make_unique<BiPolicy>(settings.selection);
    case PolicyKind::pbi:
      return std::make_unique<PbiPolicy>(settings.band_test, settings.selection);
    case PolicyKind::benefit:
      return std::make_unique<BenefitPolicy>();
  }
  throw CheckFailure("a policy of no known kind");
}

HeldImages held_images_for(const PolicySettings& settings) {
  return settings.kind == PolicyKind::pbi ? HeldImages::by_band : HeldImages::together;
}

}  // namespace rimlight
