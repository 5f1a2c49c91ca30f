#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "base/json.h"
#include "base/limits.h"
#include "base/run_context.h"
#include "base/status.h"
#include "reconstruction/dense/dense.h"
#include "reconstruction/derived_cache.h"
#include "reconstruction/pipeline_options.h"
#include "scene/board.h"
#include "scene/calibration.h"
#include "scene/ply_mesh.h"
#include "scene/point_cloud.h"
#include "scene/sparse_model.h"
#include "scene/timings.h"

namespace drupe {

/// One picture of the set. `read` gives the file's bytes; it is called more than once and from several threads, so that
/// no more pictures are in memory than are worked on.
struct SourceImage {
  std::string name;
  std::function<Result<std::string>()> read;
  std::string sha256 = "";  ///< of the file's bytes; empty: unknown, and nothing of it is looked for in a cache
};

struct ReconstructionInput {
  std::vector<SourceImage> images;         ///< in the order of the turn
  std::optional<Calibration> calibration;  ///< nothing: estimated from EXIF or the picture's size, and refined
  std::optional<Board> board;              ///< nothing: no metric scale
  Limits limits;
  /// Gives the bytes that options.similarity.vocabulary names; empty: none can be named.
  std::function<Result<std::string>(const std::string& name)> read_vocabulary = nullptr;
  DerivedCache* cache = nullptr;  ///< what is known of the pictures already; may be null; outlives the run
  RunParts run_parts = nullptr;   ///< does what has parts, perhaps elsewhere; empty: everything is done here
};

/// A picture that was left out, and why.
struct RefusedImage {
  std::string name;
  Status status;
};

struct ReconstructionOutput {
  SparseModel model;
  PointCloud cloud;   ///< empty when run_dense is false
  TriangleMesh mesh;  ///< empty unless dense.mesh is set
  std::vector<RefusedImage> refused;
  Timings timings;
};

/// The whole reconstruction of one image set (paper figure 4): features and board corners, similarity graph, view
/// clusters, matches, tracks, sparse model, dense cloud. Reports the stages of ReconstructionStages(). Pictures that do
/// not decode or differ in size from the others are left out by name. Errors: 400 for options, 422
/// `calibration_size_mismatch`, `too_few_images`, and those of the stages, `cancelled`.
Result<ReconstructionOutput> RunReconstruction(const ReconstructionInput& input, const ReconstructionOptions& options,
                                               const RunContext& context);

/// One of the parts that a stage of RunReconstruction gave to run_parts, on another machine with the same input and
/// options; of the input the pictures alone are read. Errors: as RunDensePart; 422 `bad_part` for a part with a picture
/// that `input` has not.
Result<std::string> RunReconstructionPart(const std::string& stage, std::string_view part,
                                          const ReconstructionInput& input, const ReconstructionOptions& options,
                                          const RunContext& context);

/// A stage that RunReconstruction reports, and the share of the whole time it usually takes.
struct PipelineStage {
  const char* name;
  double share;
};

/// The stages in their order; the shares sum to 1.
const std::vector<PipelineStage>& ReconstructionStages();

/// What a user needs to trust the result: registered views and the reasons of the others, reprojection errors, board
/// error and scale uncertainty, points. The `quality` of the status and of the report.
Json QualityJson(const ReconstructionOutput& output);

/// The files that a reconstruction leaves, by name: cameras.json sparse.ply colmap.zip model.nvm timings.json,
/// dense.ply and preview.ply (the same in about 50,000 points) when there is a dense cloud, and mesh.ply when there is
/// a mesh.
Result<std::map<std::string, std::string>> MakeArtifacts(const ReconstructionOutput& output);

}  // namespace drupe
