#include "reconstruction/pipeline.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "base/parallel.h"
#include "image/decode.h"
#include "reconstruction/clusters/verified_clusters.h"
#include "reconstruction/dense/poisson_mesh.h"
#include "reconstruction/dense/preview.h"
#include "reconstruction/picture_matching.h"
#include "reconstruction/picture_similarity.h"
#include "reconstruction/sparse/sparse.h"
#include "reconstruction/view_features.h"
#include "scene/cameras_json.h"
#include "scene/colmap_export.h"
#include "scene/ply.h"
#include "scene/sparse_export.h"

namespace drupe {

namespace {

/// Of preview.ply: what a browser turns smoothly.
constexpr std::size_t kPreviewPoints = 50'000;

/// The camera that matching and sparse reconstruction start from.
struct StartCamera {
  PinholeCamera camera;
  IntrinsicsSource source = IntrinsicsSource::kGiven;
};

/// Without a calibration: the focal length from EXIF, else 1.2 times the longer side, which is near most lenses.
StartCamera ChooseCamera(const ReconstructionInput& input, const ViewFeatures& views) {
  if (input.calibration) return {input.calibration->camera, IntrinsicsSource::kGiven};
  const bool from_exif = views.exif_focal_px > 0;
  const double focal = from_exif ? views.exif_focal_px : 1.2 * std::max(views.width, views.height);
  PinholeCamera camera{.width = views.width,
                       .height = views.height,
                       .fx = focal,
                       .fy = focal,
                       .cx = 0.5 * (views.width - 1),
                       .cy = 0.5 * (views.height - 1)};
  return {camera, from_exif ? IntrinsicsSource::kExif : IntrinsicsSource::kEstimated};
}

/// Runs one stage under a stopwatch and reports its beginning and end.
template <typename Stage>
auto Timed(const char* name, const RunContext& context, Timings& timings, const Stage& stage) -> decltype(stage()) {
  context.Report(name, 0.0);
  const Stopwatch watch;
  auto result = stage();
  timings.Add(name, watch);
  if (result.ok()) context.Report(name, 1.0);
  return result;
}

/// The pictures that can be used, in their order.
std::vector<SourceImage> UsedPictures(const ReconstructionInput& input, const ViewFeatures& views) {
  std::vector<SourceImage> pictures;
  for (const int source : views.sources) pictures.push_back(input.images[static_cast<std::size_t>(source)]);
  return pictures;
}

/// Verified pairs, without those that contradict the others.
Result<MatchGraph> MatchConsistently(const ReconstructionInput& input, const ViewFeatures& views,
                                     const ViewClusters& clusters, const StartCamera& start,
                                     const ReconstructionOptions& options, const RunContext& context) {
  const bool is_guess = start.source != IntrinsicsSource::kGiven;
  const std::vector<SourceImage> pictures = UsedPictures(input, views);
  std::optional<PictureMatching> ahead;
  if (!is_guess && input.cache != nullptr) ahead.emplace(pictures, input, options, context);
  FindKnownPair find_known = nullptr;
  if (ahead) find_known = [&](const ImagePair& pair) { return ahead->Known(pair); };
  DRUPE_ASSIGN_OR_RETURN(MatchGraph graph, RunMatching(views.features, clusters, start.camera, options.matching,
                                                       context, is_guess, find_known));
  const int image_count = static_cast<int>(views.features.size());
  DRUPE_RETURN_IF_ERROR(DropInconsistentPairs(image_count, options.cycles, graph).status());
  return graph;
}

/// Features to tracks: what sparse reconstruction needs of the pictures.
struct Correspondences {
  ViewClusters clusters;  ///< first by likeness, for matching; then by verified matches, for reconstruction
  MatchGraph matches;
  TrackList tracks;
};

Result<Correspondences> FindCorrespondences(const ReconstructionInput& input, const ViewFeatures& views,
                                            const StartCamera& start, const std::string& vocabulary,
                                            const ReconstructionOptions& options, const RunContext& context,
                                            Timings& timings) {
  Correspondences result;
  DRUPE_ASSIGN_OR_RETURN(const SimilarityGraph graph, Timed("similarity", context, timings, [&] {
                           return FindSimilarity(UsedPictures(input, views), views.features, input, options, vocabulary,
                                                 context);
                         }));
  DRUPE_ASSIGN_OR_RETURN(result.clusters, Timed("clusters", context, timings,
                                                [&] { return RunClusters(graph, options.clusters, context); }));
  DRUPE_ASSIGN_OR_RETURN(result.matches, Timed("matching", context, timings, [&] {
                           return MatchConsistently(input, views, result.clusters, start, options, context);
                         }));
  const int image_count = static_cast<int>(views.features.size());
  DRUPE_ASSIGN_OR_RETURN(result.clusters, ClusterVerified(image_count, result.matches, options.clusters));
  DRUPE_ASSIGN_OR_RETURN(result.tracks, Timed("tracks", context, timings, [&] {
                           return RunTracks(result.matches, views.features, options.tracks, context);
                         }));
  return result;
}

Result<SparseModel> BuildSparse(const ReconstructionInput& input, const ViewFeatures& views, const StartCamera& start,
                                const Correspondences& found, const ReconstructionOptions& options,
                                const RunContext& context) {
  SparseInput sparse;
  sparse.image_names = views.names;
  sparse.features = views.features;
  sparse.matches = &found.matches;
  sparse.tracks = &found.tracks;
  sparse.clusters = &found.clusters;
  sparse.camera = start.camera;
  sparse.intrinsics_source = start.source;
  sparse.refine_intrinsics = options.refine_intrinsics || start.source != IntrinsicsSource::kGiven;
  sparse.board = input.board;
  sparse.detections = views.detections;
  sparse.run_parts = input.run_parts;
  return RunSparse(sparse, options.sparse, context);
}

Result<RgbImage> LoadRgb(const ReconstructionInput& input, const ViewFeatures& views, int view) {
  DRUPE_ASSIGN_OR_RETURN(const std::string bytes,
                         input.images[static_cast<std::size_t>(views.sources[static_cast<std::size_t>(view)])].read());
  return DecodeRgb(bytes, input.limits);
}

/// Colours the tracks. Every track takes its colour from one view, so views can be worked on at once.
Status Colour(const ReconstructionInput& input, const ViewFeatures& views, const RunContext& context,
              SparseModel& model) {
  std::vector<Status> statuses(model.views.size());
  DRUPE_RETURN_IF_ERROR(ParallelFor(context, model.views.size(), [&](std::size_t i) {
    if (!model.views[i].cam_from_world) return;
    const Result<RgbImage> image = LoadRgb(input, views, static_cast<int>(i));
    statuses[i] = image.status();
    if (image.ok()) ColourTracks(model, static_cast<int>(i), *image);
  }));
  for (const Status& status : statuses) DRUPE_RETURN_IF_ERROR(status);
  return Status::Ok();
}

Result<PointCloud> BuildDense(const ReconstructionInput& input, const ViewFeatures& views, const SparseModel& model,
                              const ReconstructionOptions& options, const RunContext& context) {
  DenseInput dense;
  dense.model = &model;
  dense.load_rgb = [&](int view) { return LoadRgb(input, views, view); };
  dense.run_parts = input.run_parts;
  return RunDense(dense, options.dense, context);
}

/// The mesh when it is asked for; none when the points give no closed surface (a wall, half a fruit).
Result<TriangleMesh> BuildMesh(const PointCloud& cloud, const ReconstructionOptions& options,
                               const RunContext& context) {
  if (!options.dense.mesh) return TriangleMesh();
  Result<TriangleMesh> mesh = BuildPoissonMesh(cloud, context);
  if (!mesh.ok() && mesh.status().code() == "no_mesh") return TriangleMesh();
  return mesh;
}

double MeanTrackLength(const SparseModel& model) {
  if (model.tracks.empty()) return 0;
  const std::size_t observations =
      std::accumulate(model.tracks.begin(), model.tracks.end(), std::size_t{0},
                      [](std::size_t sum, const Track& track) { return sum + track.observations.size(); });
  return static_cast<double>(observations) / static_cast<double>(model.tracks.size());
}

Status RunToSparse(const ReconstructionInput& input, const ReconstructionOptions& options, const RunContext& context,
                   ViewFeatures& views, ReconstructionOutput& output) {
  const Stopwatch watch;
  DRUPE_ASSIGN_OR_RETURN(const std::string vocabulary, LoadVocabulary(input, options.similarity));
  DRUPE_ASSIGN_OR_RETURN(
      views, Timed("features", context, output.timings, [&] { return FindViewFeatures(input, options, context); }));
  const StartCamera start = ChooseCamera(input, views);
  DRUPE_ASSIGN_OR_RETURN(const Correspondences found,
                         FindCorrespondences(input, views, start, vocabulary, options, context, output.timings));
  DRUPE_ASSIGN_OR_RETURN(output.model, Timed("sparse", context, output.timings, [&] {
                           return BuildSparse(input, views, start, found, options, context);
                         }));
  DRUPE_RETURN_IF_ERROR(Colour(input, views, context, output.model));
  output.refused = views.refused;
  output.timings.sparse_cpu_s = watch.CpuSeconds();
  output.timings.sparse_wall_s = watch.WallSeconds();
  return Status::Ok();
}

}  // namespace

Result<ReconstructionOutput> RunReconstruction(const ReconstructionInput& input, const ReconstructionOptions& options,
                                               const RunContext& context) {
  DRUPE_RETURN_IF_ERROR(options.Check());
  const Stopwatch total;
  ReconstructionOutput output;
  ViewFeatures views;
  DRUPE_RETURN_IF_ERROR(RunToSparse(input, options, context, views, output));
  views.features.clear();  // the dense stage needs the memory
  if (options.run_dense) {
    const Stopwatch watch;
    DRUPE_ASSIGN_OR_RETURN(output.cloud, Timed("dense", context, output.timings, [&] {
                             return BuildDense(input, views, output.model, options, context);
                           }));
    DRUPE_ASSIGN_OR_RETURN(output.mesh, BuildMesh(output.cloud, options, context));
    output.timings.dense_cpu_s = watch.CpuSeconds();
    output.timings.dense_wall_s = watch.WallSeconds();
  }
  output.timings.total_wall_s = total.WallSeconds();
  output.timings.peak_mb = ProcessPeakMb();
  return output;
}

Result<std::string> RunReconstructionPart(const std::string& stage, std::string_view part,
                                          const ReconstructionInput& input, const ReconstructionOptions& options,
                                          const RunContext& context) {
  if (stage == "sparse") return RunSparsePart(part, options.sparse, context);
  const LoadNamedRgb load = [&](const std::string& image) -> Result<RgbImage> {
    const auto named = std::find_if(input.images.begin(), input.images.end(),
                                    [&](const SourceImage& source) { return source.name == image; });
    if (named == input.images.end())
      return Unprocessable("bad_part", "the part needs a picture that is not in the set");
    DRUPE_ASSIGN_OR_RETURN(const std::string bytes, named->read());
    return DecodeRgb(bytes, input.limits);
  };
  return RunDensePart(part, options.dense, load, context);
}

const std::vector<PipelineStage>& ReconstructionStages() {
  static const std::vector<PipelineStage> stages = {{"features", 0.12}, {"similarity", 0.02}, {"clusters", 0.01},
                                                    {"matching", 0.10}, {"tracks", 0.01},     {"sparse", 0.14},
                                                    {"dense", 0.60}};
  return stages;
}

Json QualityJson(const ReconstructionOutput& output) {
  const SparseModel& model = output.model;
  Json unregistered = Json::array();
  for (const View& view : model.views) {
    if (!view.cam_from_world) unregistered.push_back({{"image", view.image}, {"reason", view.reason}});
  }
  Json refused = Json::array();
  for (const RefusedImage& image : output.refused) {
    refused.push_back({{"image", image.name}, {"code", image.status.code()}, {"reason", image.status.message()}});
  }
  const bool metric = model.scale_source == ScaleSource::kBoard;
  return {{"registered", model.RegisteredCount()},
          {"of", model.views.size() + output.refused.size()},
          {"unregistered", unregistered},
          {"refused", refused},
          {"mean_reprojection_error_px", model.mean_reprojection_error_px},
          {"sparse_points", model.tracks.size()},
          {"mean_track_length", MeanTrackLength(model)},
          {"dense_points", output.cloud.size()},
          {"board_observations", model.board_observations},
          {"board_rms_px", metric ? Json(model.board_rms_px) : Json(nullptr)},
          {"scale_relative_sigma", metric ? Json(model.scale_relative_sigma) : Json(nullptr)}};
}

Result<std::map<std::string, std::string>> MakeArtifacts(const ReconstructionOutput& output) {
  std::map<std::string, std::string> files;
  files["cameras.json"] = DumpJson(CamerasJson(output.model), 1);
  files["sparse.ply"] = SparsePly(output.model);
  DRUPE_ASSIGN_OR_RETURN(files["colmap.zip"], ColmapZip(output.model));
  files["model.nvm"] = Nvm(output.model);
  files["timings.json"] = DumpJson(ToJson(output.timings), 1);
  if (!output.cloud.empty()) {
    files["dense.ply"] = WritePly(output.cloud);
    files["preview.ply"] = WritePly(DecimateCloud(output.cloud, kPreviewPoints));
  }
  if (!output.mesh.empty()) files["mesh.ply"] = WritePlyMesh(output.mesh);
  return files;
}

}  // namespace drupe
