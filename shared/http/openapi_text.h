#pragma once

#include <string_view>

namespace drupe {

/// The text of api/openapi.yaml as it was when this was built; made by embed_text.cmake.
extern const std::string_view kOpenApiText;

}  // namespace drupe
