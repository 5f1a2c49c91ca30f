#pragma once

#include <string_view>

namespace drupe {

/// A predefined dictionary of square markers.
struct MarkerDictionary {
  std::string_view name;  ///< "DICT_4X4_250"
  int opencv_id = 0;      ///< value of cv::aruco::PREDEFINED_DICTIONARY_NAME
  int bits = 0;           ///< cells a side inside the black border, which is one cell wide
  int marker_count = 0;   ///< ids run from 0 to marker_count - 1
};

/// The dictionary of this name; nullptr when there is none.
const MarkerDictionary* FindMarkerDictionary(std::string_view name);

}  // namespace drupe
