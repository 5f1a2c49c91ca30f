#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "scene/sparse_model.h"

namespace drupe {

/// What one way of structure from motion cost and found on a set.
struct SfmRun {
  std::string method;
  double features_cpu_s = 0;
  double matching_cpu_s = 0;  ///< choice of pairs and tracks included
  double poses_cpu_s = 0;
  double all_cpu_s = 0;  ///< from the picture files to the model
  double wall_s = 0;
  std::size_t points = 0;
  std::vector<View> views;
};

}  // namespace drupe
