#pragma once

#include "capture/calibration/calibrate.h"

namespace drupe {

/// Fills grade and verdict from the rest of the result.
void Judge(CalibrationResult& result);

}  // namespace drupe
