#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "base/status.h"
#include "geometry/pinhole_camera.h"
#include "image/image.h"
#include "scene/report.h"
#include "scene/sparse_model.h"

namespace drupe {

/// Gives the photograph of view number `view`, undecoded.
using PhotographSource = std::function<Result<std::string>(std::size_t view)>;

/// A picture of every defect, cut from the photograph that shows it best, with its contour drawn in the colour of its
/// class, and a sheet of all of them.
struct DefectPictures {
  std::map<std::string, std::string> files;  ///< "defect_1_2.png" (fruit 1, defect 2) and "contact_sheet.png"; PNG
};

/// The number of the view that shows a defect best: registered, the whole contour in the picture, no other fruit in
/// between, and the skin seen least aslant. -1 when no view does.
int BestView(const Defect& defect, std::size_t fruit, const std::vector<Fruit>& fruits, const SparseModel& model);

/// Draws them. Defects that no view shows, and photographs that cannot be read, are left out. At most `most` defects,
/// in the report's order, so that a report of hundreds stays handy. Errors: those of EncodePng.
Result<DefectPictures> DrawDefects(const std::vector<Fruit>& fruits, const SparseModel& model,
                                   const PhotographSource& photographs, int most = 60);

}  // namespace drupe
