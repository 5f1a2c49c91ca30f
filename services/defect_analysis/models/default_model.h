#pragma once

#include "base/status.h"
#include "scene/colour_model.h"

namespace drupe {

/// The model that every installation has: data/default_background.json, built into the program.
Result<ColourModel> DefaultBackgroundModel();

}  // namespace drupe
