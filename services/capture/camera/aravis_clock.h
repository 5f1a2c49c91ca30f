#pragma once

#include "capture/camera/shutter_clock.h"

typedef struct _ArvCamera ArvCamera;

namespace drupe {

/// Sets the camera's clock against ours, where it can be read: GigE Vision latches it in a bootstrap register. Of any
/// other camera, or one that refuses, nothing is learnt.
void CompareClocks(ArvCamera* camera, ShutterClock& clock);

}  // namespace drupe
