#pragma once

#include <functional>
#include <vector>

#include "core/bake/group_source.h"

namespace rimlight {

/// Imported transport as what a bake is made from.
class ImportedRows final : public GroupSource {
 public:
  /// Fills the Haar coefficients of the 64 receivers from `first_receiver` on; from any thread, for
  /// a group more than once. Receivers without coverage are black.
  using FindRows = std::function<void(std::size_t first_receiver, GroupRows& coefficients)>;

  /// `coverage` [receiver], in [0, 1], somewhere above 0; padded receivers have 0.
  ImportedRows(const PixelLayout& layout, int cube_size, std::vector<float> coverage,
               FindRows find_rows);

  const PixelLayout& layout() const override { return layout_; }
  int cube_size() const override { return cube_size_; }
  /// From a few groups all over the picture.
  float typical_size() const override { return typical_size_; }
  void find_rows(std::size_t first_receiver, BakedGroup& group) const override;
  bool has_receivers(std::size_t first_receiver) const override;

 private:
  float measure_size() const;

  PixelLayout layout_;
  int cube_size_;
  std::vector<float> coverage_;
  FindRows find_rows_;
  float typical_size_;
};

}  // namespace rimlight
