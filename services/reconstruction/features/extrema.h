#pragma once

#include <vector>

#include "reconstruction/features/scale_space.h"

namespace drupe {

/// An extremum of the difference of Gaussians, refined below the pixel.
struct Extremum {
  int octave = 0;      ///< index into the scale space
  int level = 0;       ///< the octave's level that is nearest in scale
  float x = 0, y = 0;  ///< pixels of the octave
  float sigma = 0;     ///< pixels of the octave
  float response = 0;  ///< |difference of Gaussians| there, grey values being 0..1
};

/// Finds extrema (Lowe 2004, sections 3 and 4) while the scale space is built.
class ExtremaFinder : public OctaveObserver {
 public:
  /// `mask` may be null; see RunFeatures.
  ExtremaFinder(const FeatureOptions& options, const GrayImage* mask);

  void OnRows(const Octave& octave, int octave_index, int finished_rows) override;

  /// All extrema so far, ascending by octave, then row, then level, then column.
  std::vector<Extremum> Take() { return std::move(extrema_); }

 private:
  void Begin(const Octave& octave, int octave_index);
  void ScanRow(const Octave& octave, int y);
  void Refine(const Octave& octave, int level, int x, int y);
  bool IsMasked(const Octave& octave, float x, float y) const;
  float* DogRow(int dog_level, int y) { return dog_.Row(dog_level * 3 + y % 3); }

  const FeatureOptions& options_;
  const GrayImage* mask_;
  int octave_index_ = -1;
  int finished_rows_ = 0;  ///< rows that all levels of the octave have
  int next_row_ = 0;       ///< the first row whose differences are not yet computed
  FloatImage dog_;         ///< the last three rows of each difference of Gaussians
  std::vector<int> columns_;
  std::vector<Extremum> extrema_;
};

}  // namespace drupe
