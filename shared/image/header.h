#pragma once

#include <string_view>

#include "base/status.h"
#include "image/decode.h"

namespace drupe {

/// Format, size and EXIF focal length from the header, without any limit on the size yet. Errors as ProbeImage.
Result<ImageInfo> ReadImageHeader(std::string_view bytes);

/// 422 `bad_image` with a message that starts with what is wrong.
Status BadImage(std::string_view what);

}  // namespace drupe
