#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "defect_analysis/defects/defect_options.h"

namespace drupe {

/// Colour classes of a fruit's skin. Class 0 is healthy skin.
struct Segmentation {
  std::vector<std::uint8_t> class_of;    ///< one a colour given
  std::vector<Eigen::Vector3f> centres;  ///< of the classes; the first is near zero, the healthy skin's deviation
  double davies_bouldin = 0;             ///< of the chosen number of classes; 0 when there is only healthy skin
  double threshold = 0;                  ///< deviation from which a colour is significant
};

/// The index of the centre nearest to the colour, the first of equals; 0 when there are none.
int NearestCentre(const Eigen::Vector3f& colour, const std::vector<Eigen::Vector3f>& centres);

/// Adaptive segmentation (paper 4.2): K-means whose initial centres come from the maximum-minimum distance method, with
/// K chosen by the Davies-Bouldin index (Davies and Bouldin 1979), followed by a test of significance that an intact
/// fruit fails. Three things make it fast and steady: colours are counted in a histogram first, so that an iteration
/// costs the number of distinct colours and not of points; the first centre is healthy skin, known to be at zero,
/// instead of one end of the farthest pair (which takes quadratic time to find); every further centre is the colour
/// farthest from all centres so far, in one pass. `deviations`: colour minus healthy colour, L weighted; `sigma`:
/// robust standard deviation of their lengths over healthy skin. Colours with a zero in `used` are class 0. Colours
/// beyond the threshold that no class of its own stands for (the skin's mottle drew all centres) become one class.
Segmentation SegmentColours(const std::vector<Eigen::Vector3f>& deviations, const std::vector<std::uint8_t>& used,
                            double sigma, const SegmentationOptions& options);

}  // namespace drupe
