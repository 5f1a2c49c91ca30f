#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>

#include "base/run_context.h"
#include "base/stage_parts.h"
#include "base/status.h"
#include "image/image.h"
#include "scene/point_cloud.h"
#include "scene/sparse_model.h"

namespace drupe {

/// What a dense cloud is built from.
struct DenseInput {
  /// Poses and tracks. With scale_source kBoard the world is the board's frame: z up, mm.
  const SparseModel* model = nullptr;
  /// The full picture of a view (index in model->views), camera.width x camera.height. Called once a registered view,
  /// from several threads at a time; only the part that shows the region of interest is kept.
  std::function<Result<RgbImage>(int view)> load_rgb;
  RunParts run_parts = nullptr;  ///< for options.parts; empty: everything is done here
};

/// Options of the patch-based reconstruction. Names and meanings follow PMVS (Furukawa & Ponce 2010) where it has them.
struct DenseOptions {
  /// What is reconstructed: the fruit above the board, or everything that the views see. Without a board: everything.
  enum class Scene { kFruit, kAll };

  int level = 0;              ///< finest pyramid level used: 0 full resolution, 1 half, ... (0..6)
  int csize = 1;              ///< one patch every csize x csize pixels of the finest level (1..16)
  int wsize = 7;              ///< photo-consistency over wsize x wsize pixels of the level at hand (odd, 5..15)
  double threshold = 0.6;     ///< least mean NCC of an accepted patch (0..1)
  int min_image_num = 3;      ///< least number of views that agree on a patch, its reference included (2..16)
  double max_angle_deg = 10;  ///< least angle between two of a patch's views, in degrees (1..60; PMVS: maxAngle)
  Scene scene = Scene::kFruit;
  double min_height_mm = 3;             ///< what lies lower above the board is board, not fruit (0..1000)
  std::int64_t max_points = 8'000'000;  ///< csize grows until the cloud is expected to stay below (1000..)
  std::size_t memory_limit_mb = 4000;   ///< level grows until the pictures are expected to fit (100..)
  bool epipolar_seeds = false;          ///< also start from corners matched along epipolar lines, where tracks are rare
  int parts = 0;                        ///< the finest level is split into so many parts for other machines (0..64)
  bool mesh = false;                    ///< also a closed surface of triangles (BuildPoissonMesh)

  /// 400 `invalid_option` with the field that is out of its range.
  Status Check() const;
};

/// Dense reconstruction of paper section 3.1.3: patches grown from the sparse tracks over the coarsest pyramid level,
/// refined level by level, each surface element in the view that sees it best; filtered by visibility and neighbours,
/// coloured without highlights. The cloud is in the model's world frame and unit, with every attribute of PointCloud
/// filled, and does not depend on the number of threads. Reports progress as stage "dense".
/// Errors: 400 `invalid_option`; 422 `too_few_views` (fewer than min_image_num registered), `no_seeds` (no track
/// in the region of interest), `no_dense_points`; `cancelled`; whatever load_rgb returns.
Result<PointCloud> RunDense(const DenseInput& input, const DenseOptions& options, const RunContext& context);

/// The full picture of that name.
using LoadNamedRgb = std::function<Result<RgbImage>(const std::string& image)>;

/// Does one of the parts that RunDense gave to run_parts, with the options that it had: the same bytes wherever this
/// build runs. Errors: 422 `bad_part`, `cancelled`, whatever load_rgb returns.
Result<std::string> RunDensePart(std::string_view part, const DenseOptions& options, const LoadNamedRgb& load_rgb,
                                 const RunContext& context);

}  // namespace drupe
