#include "reconstruction/pipeline_options.h"

#include <algorithm>
#include <array>
#include <string>
#include <string_view>
#include <type_traits>

#include "base/option_reader.h"

namespace drupe {

namespace {

// Every field of every stage is named once, in a Visit function; reading and writing JSON are two visitors.

template <typename Visitor>
void Visit(Visitor& visit, FeatureOptions& o) {
  visit("first_octave", o.first_octave);
  visit("doubling_max_pixels", o.doubling_max_pixels);
  visit("max_octaves", o.max_octaves);
  visit("scales_per_octave", o.scales_per_octave);
  visit("base_sigma", o.base_sigma);
  visit("input_sigma", o.input_sigma);
  visit("peak_threshold", o.peak_threshold);
  visit("edge_threshold", o.edge_threshold);
  visit("max_orientations", o.max_orientations);
  visit("max_features", o.max_features);
  visit("grid_cell_px", o.grid_cell_px);
}

template <typename Visitor>
void Visit(Visitor& visit, BoardDetectorOptions& o) {
  visit("search_width_px", o.search_width_px);
  visit("min_marker_side_px", o.min_marker_side_px);
  visit("max_homography_error_share", o.max_homography_error_share);
}

template <typename Visitor>
void Visit(Visitor& visit, SimilarityOptions& o) {
  visit("gaussians", o.gaussians);
  visit("pca_dimensions", o.pca_dimensions);
  visit("training_images", o.training_images);
  visit("training_descriptors", o.training_descriptors);
  visit("em_iterations", o.em_iterations);
  visit("descriptors_per_image", o.descriptors_per_image);
  visit("vocabulary", o.vocabulary);
}

template <typename Visitor>
void Visit(Visitor& visit, ViewClusterOptions& o) {
  visit("max_cluster_size", o.max_cluster_size);
  visit("min_overlap", o.min_overlap);
  visit("exhaustive_max_images", o.exhaustive_max_images);
  visit("links_per_image", o.links_per_image);
  visit("sequence_window", o.sequence_window);
}

template <typename Visitor>
void Visit(Visitor& visit, MatchingOptions& o) {
  visit("max_ratio", o.max_ratio);
  visit("max_error_px", o.max_error_px);
  visit("guessed_lens", o.guessed_lens);
  visit("confidence", o.confidence);
  visit("max_iterations", o.max_iterations);
  visit("min_inliers", o.min_inliers);
  visit("min_angle_deg", o.min_angle_deg);
  visit("exhaustive_features", o.exhaustive_features);
  visit("guided", o.guided);
  visit("guided_max_ratio", o.guided_max_ratio);
  visit("drop_static", o.drop_static);
  visit("static_radius_px", o.static_radius_px);
  visit("static_min_share", o.static_min_share);
}

template <typename Visitor>
void Visit(Visitor& visit, CycleOptions& o) {
  visit("max_rotation_deg", o.max_rotation_deg);
  visit("max_direction_deg", o.max_direction_deg);
}

template <typename Visitor>
void Visit(Visitor& visit, TrackOptions& o) {
  visit("min_length", o.min_length);
}

template <typename Visitor>
void Visit(Visitor& visit, SparseOptions& o) {
  visit("method", o.method);
  visit("adjustment", o.adjustment);
  visit("max_reprojection_error_px", o.max_reprojection_error_px);
  visit("min_triangulation_angle_deg", o.min_triangulation_angle_deg);
  visit("feature_loss_px", o.feature_loss_px);
  visit("board_loss_px", o.board_loss_px);
  visit("min_pnp_inliers", o.min_pnp_inliers);
  visit("max_ransac_iterations", o.max_ransac_iterations);
  visit("min_board_corners", o.min_board_corners);
  visit("min_board_views", o.min_board_views);
  visit("min_registered_share", o.min_registered_share);
  visit("complete_tracks", o.complete_tracks);
  visit("parts", o.parts);
}

template <typename Visitor>
void Visit(Visitor& visit, DenseOptions& o) {
  visit("level", o.level);
  visit("csize", o.csize);
  visit("wsize", o.wsize);
  visit("threshold", o.threshold);
  visit("min_image_num", o.min_image_num);
  visit("max_angle_deg", o.max_angle_deg);
  visit("scene", o.scene);
  visit("min_height_mm", o.min_height_mm);
  visit("max_points", o.max_points);
  visit("memory_limit_mb", o.memory_limit_mb);
  visit("epipolar_seeds", o.epipolar_seeds);
  visit("parts", o.parts);
  visit("mesh", o.mesh);
}

/// Calls `section(name, stage_options)` for every stage, in the order of the data.
template <typename Section>
void VisitSections(Section&& section, ReconstructionOptions& o) {
  section("features", o.features);
  section("board", o.board);
  section("similarity", o.similarity);
  section("clusters", o.clusters);
  section("matching", o.matching);
  section("cycles", o.cycles);
  section("tracks", o.tracks);
  section("sparse", o.sparse);
  section("dense", o.dense);
}

/// The names of a choice's values in JSON, in the order of the enumeration.
using ChoiceNames = std::array<const char*, 2>;
const ChoiceNames& NamesOf(DenseOptions::Scene) {
  static const ChoiceNames names = {"fruit", "all"};
  return names;
}
const ChoiceNames& NamesOf(GuessedLens) {
  static const ChoiceNames names = {"essential", "fundamental"};
  return names;
}
const ChoiceNames& NamesOf(SparseMethod) {
  static const ChoiceNames names = {"clusters", "whole"};
  return names;
}
const ChoiceNames& NamesOf(AdjustmentMethod) {
  static const ChoiceNames names = {"distributed", "monolithic"};
  return names;
}

/// Visitor that fills fields from JSON.
class FieldReader {
 public:
  FieldReader(const Json& json, const std::string& path) : reader_(json, path) {}

  template <typename T>
  void operator()(std::string_view key, T& field) {
    reader_.Read(key, field);
  }
  void operator()(std::string_view key, std::optional<int>& field) {
    constexpr int kAbsent = -1'000'000;
    int value = field.value_or(kAbsent);
    reader_.Read(key, value);
    if (value != kAbsent) field = value;
  }
  void operator()(std::string_view key, std::int64_t& field) { ReadWhole(key, field); }
  void operator()(std::string_view key, std::size_t& field) { ReadWhole(key, field); }
  template <typename Choice>
  requires std::is_enum_v<Choice>
  void operator()(std::string_view key, Choice& field) {
    const auto& names = NamesOf(field);
    std::string name = names[static_cast<std::size_t>(field)];
    reader_.Read(key, name);
    const auto found = std::find(names.begin(), names.end(), name);
    if (found != names.end()) {
      field = static_cast<Choice>(found - names.begin());
      return;
    }
    const std::string path = reader_.PathOf(key);
    choice_error_ =
        InvalidArgument("invalid_option", path + " must be \"" + names[0] + "\" or \"" + names[1] + "\"", path);
  }

  Status Finish() const { return choice_error_.ok() ? reader_.Finish() : choice_error_; }

 private:
  template <typename T>
  void ReadWhole(std::string_view key, T& field) {
    int value = static_cast<int>(field);
    reader_.Read(key, value);
    field = static_cast<T>(value < 0 ? 0 : value);  // the stage's Check() refuses 0
  }

  OptionReader reader_;
  Status choice_error_;
};

/// Visitor that writes fields to JSON.
class FieldWriter {
 public:
  explicit FieldWriter(Json& json) : json_(json) {}

  template <typename T>
  void operator()(std::string_view key, const T& field) {
    json_[std::string(key)] = field;
  }
  void operator()(std::string_view key, const std::optional<int>& field) {
    if (field) json_[std::string(key)] = *field;
  }
  template <typename Choice>
  requires std::is_enum_v<Choice>
  void operator()(std::string_view key, const Choice& field) {
    json_[std::string(key)] = NamesOf(field)[static_cast<std::size_t>(field)];
  }

 private:
  Json& json_;
};

/// A stage's message with the stage's name in its field: a stage does not know under which key it stands.
Status NameStage(const std::string& stage, const Status& status) {
  if (status.ok() || status.field().starts_with(stage + ".")) return status;
  return {status.kind(), status.code(), stage + ": " + status.message(), stage + "." + status.field()};
}

}  // namespace

Status ReconstructionOptions::Check() const {
  Status first;
  const auto check = [&first](const char* stage, const auto& options) {
    if (first.ok()) first = NameStage(stage, options.Check());
  };
  ReconstructionOptions copy = *this;
  VisitSections(check, copy);
  return first;
}

Result<ReconstructionOptions> ParseReconstructionOptions(const Json& json) {
  ReconstructionOptions options;
  if (json.is_null()) return options;
  OptionReader reader(json, "options");
  Status nested;
  VisitSections(
      [&](const char* name, auto& section) {
        const Json* found = reader.Nested(name);
        if (found == nullptr || !nested.ok()) return;
        FieldReader fields(*found, reader.PathOf(name));
        Visit(fields, section);
        nested = fields.Finish();
      },
      options);
  reader.Read("refine_intrinsics", options.refine_intrinsics);
  reader.Read("run_dense", options.run_dense);
  DRUPE_RETURN_IF_ERROR(nested);
  DRUPE_RETURN_IF_ERROR(reader.Finish());
  DRUPE_RETURN_IF_ERROR(options.Check());
  return options;
}

Json ToJson(const ReconstructionOptions& options) {
  Json json = Json::object();
  ReconstructionOptions copy = options;
  VisitSections(
      [&json](const char* name, auto& section) {
        Json fields = Json::object();
        FieldWriter writer(fields);
        Visit(writer, section);
        json[name] = fields;
      },
      copy);
  json["refine_intrinsics"] = options.refine_intrinsics;
  json["run_dense"] = options.run_dense;
  return json;
}

}  // namespace drupe
