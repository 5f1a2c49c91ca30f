#pragma once

#include "defect_analysis/fruit/background_options.h"
#include "defect_analysis/fruit/colour_classifier.h"
#include "scene/fruit_cloud.h"
#include "scene/point_cloud.h"

namespace drupe {

/// What colour did to one fruit.
struct ForeignColours {
  bool known = false;       ///< the model takes enough of the certain skin for fruit
  double known_share = 0;   ///< that share, 0..1
  std::size_t removed = 0;  ///< points taken off
};

/// Takes points of the background's colour off a fruit where the surface leaves doubt: outside of it by more than
/// doubt_mm and doubt_sigma standard deviations, where needle, board and their mixtures with the skin lie. What sinks
/// in, as cracks and decay do, and what lies on the surface is skin whatever its colour. A model that would call more
/// than a tenth (known_share) of the certain skin background does not know this fruit and has no say.
ForeignColours RemoveForeignColours(const ColourClassifier& classifier, const BackgroundOptions& options,
                                    FruitCloud& fruit);

/// The points that the model takes for fruit: for clouds in which geometry alone finds none.
PointCloud KeepFruitColours(const ColourClassifier& classifier, const PointCloud& cloud);

}  // namespace drupe
