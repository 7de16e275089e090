#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/base/json_reader.h"
#include "core/transport/bake_folder.h"
#include "core/transport/curve_receivers.h"
#include "core/transport/tensor_file.h"

namespace rimlight {

// What bakes of kind brdf_curve have beside those of kind image_haar (docs/formats/bake.md),
// written, and read and checked. `path` is for errors; they name it and the tensor.

/// As scene sources name it: "cook_torrance".
const std::string& brdf_model_name(BrdfModel model);

// Fields of the manifest. Reading throws Error at the field.
nlohmann::json curve_materials_to_json(const std::vector<CurveMaterial>& materials);
std::vector<CurveMaterial> read_curve_materials(const JsonReader& json);
/// Names, errors and shares of samples; their factors are tensors.
nlohmann::json measured_to_json(const std::vector<CurveMaterial>& measured);
std::vector<CurveMaterial> read_measured(const JsonReader& json);

/// That materials which are measured name one that there is.
void check_measured_names(const JsonReader& materials, const BakeManifest& manifest);

std::vector<TensorShape> curve_tensors(const CurveReceivers& receivers);
void write_curves(TensorFileWriter& writer, const CurveReceivers& receivers);

/// Finite, unit vectors, shares in (0, 1], tints in [0, 10⁶]; materials and receivers that there
/// are, in the order of CurveReceivers.
std::vector<CurveSurface> read_curve_surfaces(const TensorFile& file, const std::string& path,
                                              const BakeManifest& manifest);
/// A view of the file's memory: fifths of 0 … 5, as many mixed blocks as there are kinds of them.
SkyVisibilityView read_sky_visibility(const TensorFile& file, const std::string& path,
                                      const BakeManifest& manifest, std::size_t surface_count);
/// Sets the factors of measured BRDFs, finite and ≥ 0, and of the materials that name them.
void read_measured_factors(const TensorFile& file, const std::string& path, BakeManifest& manifest);

}  // namespace rimlight
