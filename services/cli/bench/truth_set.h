#pragma once

#include <string>
#include <vector>

#include "base/json.h"
#include "base/limits.h"
#include "base/status.h"
#include "geometry/rigid3.h"
#include "geometry/sim3.h"
#include "reconstruction/pipeline.h"

namespace drupe {

/// Where a picture was truly taken from.
struct TrueView {
  std::string image;
  Rigid3 cam_from_world;  ///< world: the board's frame, mm
};

/// A picture set whose truth is known: a directory with images/, calibration.json, truth.json and, for a turntable,
/// board.json. What the benches compare with.
struct TruthSet {
  std::string directory;
  std::string name;  ///< the directory's own name
  ReconstructionInput input;
  std::vector<TrueView> views;
  Json truth;  ///< the whole of truth.json
};

/// The name of a picture or directory without its extension.
std::string Stem(const std::string& name);

/// Errors: 400 with the file that is missing or wrong.
Result<TruthSet> LoadTruthSet(const std::string& directory);

/// Errors of poses against the truth after the best similarity between the camera centres (an arbitrary frame costs
/// nothing; `scale` tells what a metric result was off by).
struct PoseErrors {
  int registered = 0;
  int of = 0;
  double mean_centre_mm = 0;
  double max_centre_mm = 0;
  double mean_rotation_deg = 0;
  double max_rotation_deg = 0;
  Sim3 truth_from_model;
};

/// Poses of `views` against the set's truth, by the pictures' names without their extension. Errors: 422 when fewer
/// than three views have both.
Result<PoseErrors> ComparePoses(const TruthSet& set, const std::vector<View>& views);

}  // namespace drupe
