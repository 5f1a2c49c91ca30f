#include "reconstruction/picture_features.h"

#include <optional>
#include <utility>

#include "image/decode.h"
#include "scene/features_file.h"

namespace drupe {
namespace {

/// [[id, x0, y0, x1, y1, x2, y2, x3, y3], ...]; the numbers come back bit by bit.
std::string DetectionText(const BoardDetection& detection) {
  Json list = Json::array();
  for (const MarkerDetection& marker : detection) {
    Json row = {marker.id};
    for (const Eigen::Vector2d& corner : marker.corners_px) {
      row.push_back(corner.x());
      row.push_back(corner.y());
    }
    list.push_back(std::move(row));
  }
  return DumpJson(list);
}

Result<BoardDetection> ParseDetection(const std::string& text) {
  DRUPE_ASSIGN_OR_RETURN(const Json list, ParseJson(text));
  BoardDetection detection;
  try {
    for (const Json& row : list) {
      MarkerDetection marker{row.at(0).get<int>(), {}};
      for (std::size_t c = 0; c < marker.corners_px.size(); ++c) {
        marker.corners_px[c] = {row.at(1 + 2 * c).get<double>(), row.at(2 + 2 * c).get<double>()};
      }
      detection.push_back(marker);
    }
  } catch (const Json::exception& error) {
    return Internal("bad_detection", std::string("a kept board detection is malformed: ") + error.what());
  }
  return detection;
}

/// One picture, which is decoded once, and only when something is missing.
class PictureWork {
 public:
  PictureWork(const SourceImage& source, const ReconstructionInput& input, const ReconstructionOptions& options,
              const RunContext& context)
      : source_(source), input_(input), options_(options), option_json_(ToJson(options)), context_(context) {}

  Result<Features> FindFeatures() {
    const Json parameters = {{"picture", source_.sha256}, {"features", option_json_["features"]}};
    const auto make = [this]() -> Result<std::string> {
      DRUPE_ASSIGN_OR_RETURN(const Features features, ComputeFeatures());
      return WriteFeatures(features);
    };
    if (!IsCached(source_, input_)) return ComputeFeatures();
    DRUPE_ASSIGN_OR_RETURN(const std::string bytes,
                           input_.cache->FindOrMake(DerivedKey("features", parameters), make, context_));
    return ReadFeatures(bytes);
  }

  Result<BoardDetection> FindBoard() {
    const Json parameters = {{"picture", source_.sha256},
                             {"detector", option_json_["board"]},
                             {"board", ToJson(*input_.board)},
                             {"calibration", input_.calibration ? ToJson(*input_.calibration) : Json()}};
    const auto make = [this]() -> Result<std::string> {
      DRUPE_ASSIGN_OR_RETURN(const BoardDetection detection, ComputeBoard());
      return DetectionText(detection);
    };
    if (!IsCached(source_, input_)) return ComputeBoard();
    DRUPE_ASSIGN_OR_RETURN(const std::string text,
                           input_.cache->FindOrMake(DerivedKey("board", parameters), make, context_));
    return ParseDetection(text);
  }

 private:
  Result<const GrayImage*> Gray() {
    if (!gray_) {
      DRUPE_ASSIGN_OR_RETURN(const std::string bytes, source_.read());
      DRUPE_ASSIGN_OR_RETURN(gray_, DecodeGray(bytes, input_.limits));
    }
    return &*gray_;
  }

  Result<Features> ComputeFeatures() {
    DRUPE_ASSIGN_OR_RETURN(const GrayImage* gray, Gray());
    return RunFeatures(*gray, options_.features, context_);
  }

  Result<BoardDetection> ComputeBoard() {
    DRUPE_ASSIGN_OR_RETURN(const GrayImage* gray, Gray());
    BoardDetectorOptions board_options = options_.board;
    if (input_.calibration) board_options.camera = input_.calibration->camera;
    return DetectBoard(*gray, *input_.board, board_options);
  }

  const SourceImage& source_;
  const ReconstructionInput& input_;
  const ReconstructionOptions& options_;
  const Json option_json_;
  const RunContext& context_;
  std::optional<GrayImage> gray_;
};

}  // namespace

Result<PictureFeatures> FindPictureFeatures(const SourceImage& source, const ReconstructionInput& input,
                                            const ReconstructionOptions& options, const RunContext& context) {
  PictureWork work(source, input, options, context);
  PictureFeatures found;
  DRUPE_ASSIGN_OR_RETURN(found.features, work.FindFeatures());
  if (!input.board) return found;
  DRUPE_ASSIGN_OR_RETURN(found.detection, work.FindBoard());
  return found;
}

Result<Features> FindFeatures(const SourceImage& source, const ReconstructionInput& input,
                              const ReconstructionOptions& options, const RunContext& context) {
  return PictureWork(source, input, options, context).FindFeatures();
}

bool IsCached(const SourceImage& source, const ReconstructionInput& input) {
  return input.cache != nullptr && !source.sha256.empty();
}

}  // namespace drupe
