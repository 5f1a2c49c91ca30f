#pragma once

#include <optional>

#include "base/run_context.h"
#include "base/status.h"
#include "image/image.h"
#include "scene/features.h"

namespace drupe {

/// How local features are found (Lowe 2004) and how many of them are kept.
struct FeatureOptions {
  /// The octave to begin with: 0 is the picture itself, -1 the picture doubled, 1 the picture halved. Nothing: -1 for
  /// pictures up to `doubling_max_pixels`, else 0.
  std::optional<int> first_octave;
  /// See first_octave. Small pictures have few fine structures to spare; in large ones doubling costs four times the
  /// work.
  int doubling_max_pixels = 1'000'000;
  int max_octaves = 8;        ///< 1..16; fewer when the picture is exhausted before
  int scales_per_octave = 3;  ///< 1..5; levels per doubling of scale at which extrema are sought
  double base_sigma = 1.6;    ///< 1.2..2.4, pixels of the octave; blur of each octave's first level
  double input_sigma = 0.5;   ///< 0..0.6, pixels; blur the camera is assumed to have left
  /// Least |difference of Gaussians| of an extremum, grey values being 0..1, times scales_per_octave. Lowe: 0.04. The
  /// skin of a fruit is weakly textured, hence lower; max_features bounds what noise would bring.
  double peak_threshold = 0.003;
  double edge_threshold = 10;  ///< > 1; largest ratio of the principal curvatures
  int max_orientations = 2;    ///< 1..4 per extremum; each is a keypoint of its own
  /// Most extrema kept. The strongest are kept cell by cell of a grid, so that weak texture beside a strong one has its
  /// share.
  int max_features = 10'000;
  int grid_cell_px = 128;  ///< 8..4096, side of a cell of that grid, pixels of the full picture

  /// 400 `invalid_option` naming the field that is out of its range.
  Status Check() const;
};

/// SIFT features of one picture, ordered by scale (coarsest first), then by row and column; the same for any number of
/// threads. One call works on one thread; calls on different threads do not disturb each other. `mask`, when given, has
/// the picture's size; no extremum is sought where it is 0. Errors: 400 `invalid_option`, 400 `invalid_mask`, 422
/// `image_too_small` (a side under 16 pixels), `cancelled`.
Result<Features> RunFeatures(const GrayImage& image, const FeatureOptions& options, const RunContext& context,
                             const GrayImage* mask = nullptr);

}  // namespace drupe
