#pragma once

#include <optional>

#include "reconstruction/sparse/sfm_state.h"

namespace drupe {

/// The focal length in pixels that the board's pictures agree on, when nothing better than a guess is known: Zhang's
/// two constraints a homography (2000), with square pixels and the principal point of `state.camera`, least squares
/// over the views. Good to a few per cent, which is near enough for poses to be found and the camera to be refined.
/// Nothing when no view sees enough of a plane board, or all see it face on.
std::optional<double> FocalFromBoard(const SfmState& state, int min_corners);

}  // namespace drupe
