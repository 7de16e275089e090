// Each way in which the files of a bake of kind brdf_curve can be bad: an Error that says where.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "core/base/files.h"
#include "core/transport/bake_folder.h"
#include "core/transport/curve_tensors.h"
#include "tests/support/error_of.h"
#include "tests/support/forged_bake.h"
#include "tests/support/small_curve_bake.h"
#include "tests/support/temporary_folder.h"

namespace rimlight {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using test::CurveBakeParts;
using test::TemporaryFolder;
using ::testing::HasSubstr;

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

std::string read(const fs::path& path) { return read_file(path, SIZE_MAX); }

std::string error_of_opening(const fs::path& folder) {
  return test::error_of([&] { Bake(folder).verify(); });
}

/// A tensor of curves.safetensors, to be changed.
struct Tensor {
  TensorShape shape;
  std::string bytes;

  template <typename T>
  void set(std::size_t i, T value) {
    std::memcpy(bytes.data() + i * sizeof value, &value, sizeof value);
  }
  void cut_first_row() {
    bytes.resize(bytes.size() - bytes.size() / shape.shape[0]);
    --shape.shape[0];
  }
};
using Tensors = std::vector<Tensor>;

Tensor& named(Tensors& tensors, const std::string& name) {
  return *std::ranges::find_if(tensors, [&](const Tensor& t) { return t.shape.name == name; });
}

/// One bake whose curves.safetensors is replaced again and again, its hashes right.
class ForgedCurveBake : public testing::Test {
 protected:
  ForgedCurveBake() {
    write_curve_bake(path_, parts_);
    std::string manifest = read(path_ / kManifestFile);
    good_manifest_ = json::parse(manifest);
    const JsonReader reader(good_manifest_, "manifest");
    const TensorFile file(path_ / kCurvesFile,
                          TensorFileSummary::from_json(reader.member("files").member(kCurvesFile)));
    for (const TensorShape& shape : curve_tensors(parts_.receivers())) {
      const auto bytes = file.tensor<char>(shape.name, shape.type);
      good_.push_back({shape, std::string(bytes.begin(), bytes.end())});
    }
  }

  std::string error_with(const std::function<void(Tensors&)>& edit) const {
    Tensors tensors = good_;
    edit(tensors);
    const fs::path scratch = folder_ / "scratch";
    std::vector<TensorShape> shapes;
    for (const Tensor& tensor : tensors) shapes.push_back(tensor.shape);
    {
      TensorFileWriter writer(scratch, shapes);
      for (const Tensor& tensor : tensors) writer.append(std::span<const char>(tensor.bytes));
      writer.finish();
    }
    test::forge_file(path_, kCurvesFile, read(scratch));
    return error_of_opening(path_);
  }

  template <typename T>
  std::string error_with_value(const std::string& name, std::size_t i, T value) const {
    return error_with([&](Tensors& tensors) { named(tensors, name).set(i, value); });
  }

  std::string error_with_manifest(const std::function<void(json&)>& edit) const {
    json manifest = good_manifest_;
    edit(manifest);
    test::forge_manifest(path_, manifest.dump());
    return error_of_opening(path_);
  }

  static auto names(const std::string& tensor) {
    return testing::AllOf(HasSubstr("a.bake"), HasSubstr(kCurvesFile),
                          HasSubstr("\"" + tensor + "\""));
  }

  TemporaryFolder folder_;
  fs::path path_ = folder_ / "a.bake";
  CurveBakeParts parts_;
  json good_manifest_;
  Tensors good_;
};

TEST_F(ForgedCurveBake, TensorsThatAreMissingOrOfAnotherTypeOrShapeAreNamed) {
  ASSERT_EQ(error_with([](Tensors&) {}), "no error");
  ASSERT_EQ(good_.size(), 11u);
  for (std::size_t i = 0; i < good_.size(); ++i) {
    const std::string name = good_[i].shape.name;
    EXPECT_THAT(error_with([&](Tensors& t) { t.erase(t.begin() + static_cast<long>(i)); }),
                names(name));
    EXPECT_THAT(error_with([&](Tensors& t) {
                  Tensor& tensor = t[i];
                  const bool is_bytes = tensor.shape.type == ElementType::u8;
                  tensor.shape.type = is_bytes ? ElementType::u16 : ElementType::u8;
                  tensor.shape.shape = {tensor.bytes.size() / (is_bytes ? 2 : 1)};
                }),
                names(name));
    // Fewer receivers are as good as any; what follows does not fit then.
    EXPECT_THAT(error_with([&](Tensors& t) { t[i].cut_first_row(); }),
                names(name == "receiver" ? "material" : name));
    if (good_[i].shape.shape.size() > 1) {
      EXPECT_THAT(error_with([&](Tensors& t) { std::ranges::reverse(t[i].shape.shape); }),
                  names(name));
    }
  }
}

TEST_F(ForgedCurveBake, SurfacesThatAreNoneAreNamed) {
  EXPECT_THAT(error_with_value("receiver", 59, 4 * 4096u), names("receiver"));
  EXPECT_THAT(error_with_value("receiver", 3, 0xffffffffu), names("receiver"));
  EXPECT_THAT(error_with_value("material", 7, 7u), names("material"));
  for (const float bad : {0.0f, -0.5f, 1.001f, kInfinity, kNan}) {
    EXPECT_THAT(error_with_value("share", 5, bad), names("share")) << bad;
  }
  for (const float bad : {-0.001f, 2e6f, kInfinity, kNan}) {
    EXPECT_THAT(error_with_value("tint", 3 * 5 + 1, bad), names("tint")) << bad;
  }
  // Each component of surface 8's third point: normal, tangent, geometric normal, outgoing.
  for (std::size_t component = 0; component < 12; ++component) {
    const std::size_t at = (8 * kSurfacePoints + 2) * 12 + component;
    for (const float bad : {kNan, -kInfinity}) {
      EXPECT_THAT(error_with_value("points", at, bad), names("points")) << component;
    }
    const std::string error = error_with_value("points", at, 1.5f);
    if (component / 3 == 1) {
      EXPECT_EQ(error, "no error");  // a tangent is of any length
    } else {
      EXPECT_THAT(error, names("points")) << component;
    }
  }
  EXPECT_EQ(error_with_value("share", 5, 1.0f), "no error");
  EXPECT_EQ(error_with_value("tint", 16, 0.0f), "no error");
}

TEST_F(ForgedCurveBake, SurfacesOutOfOrderAreRefused) {
  const auto swap = [&](std::size_t i) {
    return error_with([&](Tensors& tensors) {
      for (const char* const name : {"receiver", "material"}) {
        Tensor& tensor = named(tensors, name);
        std::swap_ranges(tensor.bytes.begin() + static_cast<long>(4 * i),
                         tensor.bytes.begin() + static_cast<long>(4 * i + 4),
                         tensor.bytes.begin() + static_cast<long>(4 * i + 4));
      }
    });
  };
  int different_tiles = 0, different_materials = 0;
  for (std::size_t i = 0; i + 1 < parts_.surfaces.size(); ++i) {
    const CurveSurface &one = parts_.surfaces[i], &next = parts_.surfaces[i + 1];
    different_tiles += one.receiver / kTileReceivers != next.receiver / kTileReceivers ? 1 : 0;
    different_materials += one.material != next.material ? 1 : 0;
    EXPECT_THAT(swap(i), names("receiver")) << i;
  }
  EXPECT_GE(different_tiles, 3);
  EXPECT_GE(different_materials, 10);
}

TEST_F(ForgedCurveBake, SkiesThatDoNotFitTheirBlocksAreNamed) {
  EXPECT_THAT(error_with_value<std::uint8_t>("blocks", 17, 3), names("blocks"));
  EXPECT_THAT(error_with_value<std::uint8_t>("blocks", 17, 255), names("blocks"));
  EXPECT_THAT(error_with_value<std::uint64_t>("first_mixed", 0, 1), names("first_mixed"));
  EXPECT_THAT(error_with_value("first_mixed", 9, ~std::uint64_t{0}), names("first_mixed"));
  EXPECT_THAT(error_with_value("first_mixed", 60, std::uint64_t{1} << 40), names("first_mixed"));
  for (const char bad : {'\x06', '\x60', '\xff', '\x5a'}) {
    EXPECT_THAT(error_with_value("mixed", 33, bad), names("mixed")) << int{bad};
  }
  EXPECT_EQ(error_with_value<std::uint8_t>("mixed", 33, 0x50), "no error");
  // One more and one fewer mixed block than there are kinds.
  const auto mixed = static_cast<std::uint8_t>(SkyVisibilityView::Block::mixed);
  for (std::size_t i = 0; i < 12; ++i) {
    const bool is_mixed = named(good_, "blocks").bytes[i] == static_cast<char>(mixed);
    EXPECT_THAT(error_with_value("blocks", i, is_mixed ? std::uint8_t{0} : mixed),
                names("first_mixed"));
  }
}

TEST_F(ForgedCurveBake, FactorsThatAreNotFiniteOrBelowZeroAreNamed) {
  for (const char* const name : {"half_angle", "difference_angle", "rest"}) {
    for (const float bad : {-1e-6f, kInfinity, kNan}) {
      EXPECT_THAT(error_with_value(name, 130, bad), names(name)) << bad;
    }
    EXPECT_EQ(error_with_value(name, 130, 0.0f), "no error");
  }
}

TEST_F(ForgedCurveBake, ManifestsThatDoNotFitAreRefusedNamingTheField) {
  ASSERT_EQ(error_with_manifest([](json&) {}), "no error");
  for (const char* const field : {"materials", "measured_brdfs"}) {
    EXPECT_THAT(error_with_manifest([&](json& m) { m.erase(field); }),
                HasSubstr("\"" + std::string(field) + "\""));
    for (const auto& member : good_manifest_[field][0].items()) {
      EXPECT_THAT(error_with_manifest([&](json& m) { m[field][0].erase(member.key()); }),
                  HasSubstr("\"" + member.key() + "\""));
    }
    EXPECT_THAT(error_with_manifest([&](json& m) { m[field][1]["colour"] = 1; }),
                HasSubstr("colour"));
    EXPECT_THAT(error_with_manifest([&](json& m) { m[field][1]["name"] = m[field][0]["name"]; }),
                HasSubstr("/" + std::string(field) + "/1: "));
    // As many as there are in the tensors.
    EXPECT_THAT(error_with_manifest([&](json& m) { m[field].erase(m[field].size() - 1); }),
                HasSubstr(kCurvesFile));
  }
  struct Case {
    const char* pointer;
    json value;
  };
  for (const Case& one :
       {Case{"/materials", json::array()}, Case{"/materials/6/measured", "velvet"},
        Case{"/materials/6/measured", 3}, Case{"/materials/2/model", "velvet"},
        Case{"/materials/2/name", 3}, Case{"/materials/2/albedo", {0.1, 1.1, 0.1}},
        Case{"/materials/2/specular", {0.1, 0.1}}, Case{"/materials/2/exponent", {0.5, 1}},
        Case{"/materials/2/exponent", {1, 2e5}}, Case{"/materials/2/roughness", {0.2, 0}},
        Case{"/materials/2/eta", {101, 1, 1}}, Case{"/materials/2/k", {0, -1, 0}},
        Case{"/measured_brdfs/1/valid_share", 1.5},
        Case{"/measured_brdfs/1/fit_error_logarithmic", {-1, 0, 0}},
        Case{"/measured_brdfs/1/fit_error_relative", {0, 0}}}) {
    EXPECT_THAT(
        error_with_manifest([&](json& m) { m[json::json_pointer(one.pointer)] = one.value; }),
        HasSubstr(one.pointer))
        << one.value;
  }
}

TEST_F(ForgedCurveBake, MeasuredMaterialsHaveANameAndNoParameters) {
  EXPECT_EQ(good_manifest_["materials"][6],
            (json{{"name", "coat"}, {"model", "measured"}, {"measured", "cloth"}}));
  EXPECT_THAT(error_with_manifest([](json& m) {
                m["materials"][6]["albedo"] = {0, 0, 0};
              }),
              HasSubstr("albedo"));
  EXPECT_THAT(error_with_manifest([](json& m) { m["materials"][6].erase("measured"); }),
              HasSubstr("\"measured\""));
  EXPECT_THAT(error_with_manifest([](json& m) { m["materials"][2]["measured"] = "cloth"; }),
              HasSubstr("measured"));
  EXPECT_THAT(error_with_manifest([](json& m) { m["materials"][2]["model"] = 3; }),
              HasSubstr("/materials/2/model"));
}

TEST_F(ForgedCurveBake, KindAndFieldsBelongTogether) {
  EXPECT_THAT(error_with_manifest([](json& m) { m["kind"] = kImageKind; }),
              HasSubstr("\"materials\""));
  EXPECT_THAT(error_with_manifest([](json& m) { m["files"].erase(kCurvesFile); }),
              HasSubstr(kCurvesFile));
  const fs::path image = folder_ / "image.bake";
  test::write_small_bake(image, {});
  json manifest = json::parse(read(image / kManifestFile));
  manifest["kind"] = kCurveKind;
  test::forge_manifest(image, manifest.dump());
  EXPECT_THAT(error_of_opening(image), HasSubstr("\"materials\""));
  // Curves need blocks of 8 × 8 texels: this one has faces of 4 × 4.
  manifest["materials"] = good_manifest_["materials"];
  manifest["measured_brdfs"] = good_manifest_["measured_brdfs"];
  test::forge_manifest(image, manifest.dump());
  test::forge_file(image, kCurvesFile, read(path_ / kCurvesFile));
  EXPECT_THAT(error_of_opening(image),
              testing::AllOf(HasSubstr(kCurvesFile), HasSubstr("expected at least 8")));
}

}  // namespace
}  // namespace rimlight
